// The back ends that every contract's suite runs against, and how a test gets a rig of each.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "hal/mock/fault.hpp"
#include "hal/rig.hpp"

namespace raysteer::hal {

/// One rig whose time a test moves.
class Bench {
 public:
  Bench() = default;
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
  virtual ~Bench() = default;
  virtual Rig rig() = 0;
  virtual void run(std::chrono::nanoseconds time) = 0;
  /// A person at the switches of the interlock.
  virtual void open_switch(bool open) = 0;
  RigTime now() { return rig().clock.now(); }
};

struct BackEnd {
  std::string name;
  bool plays = false;  ///< has a PatternPlayer
  std::function<std::unique_ptr<Bench>(std::vector<mock::Fault>)> make;
};

/// Every back end there is: so far, mocks.
const std::vector<BackEnd>& back_ends();
std::vector<BackEnd> back_ends_that_play();

inline std::string name_of(const testing::TestParamInfo<BackEnd>& info) { return info.param.name; }
inline void PrintTo(const BackEnd& back_end, std::ostream* out) { *out << back_end.name; }

/// The base of every suite: `bench({{"mirror", "unplug"}})` is a rig with that trouble from rig time 0 on.
class Contract : public testing::TestWithParam<BackEnd> {
 protected:
  std::unique_ptr<Bench> bench(std::vector<mock::Fault> faults = {}) { return GetParam().make(std::move(faults)); }
};

/// Patterns for the panel of every back end: white, black and four steps of a sinusoid.
PatternSequence six_patterns();

inline constexpr std::chrono::nanoseconds kEarlier{1};

}  // namespace raysteer::hal

/// The operation's error is exactly this one.
#define EXPECT_REFUSED(operation, code)                                                                        \
  do {                                                                                                         \
    auto raysteer_answer = (operation);                                                                        \
    ASSERT_FALSE(raysteer_answer.has_value()) << "accepted";                                                   \
    EXPECT_EQ(to_string(raysteer_answer.error().rcode), to_string(code)) << raysteer_answer.error().message(); \
  } while (false)
#define ASSERT_OK(operation)                                                       \
  do {                                                                             \
    auto raysteer_answer = (operation);                                            \
    ASSERT_TRUE(raysteer_answer.has_value()) << raysteer_answer.error().message(); \
  } while (false)
#define EXPECT_OK(operation)                                                       \
  do {                                                                             \
    auto raysteer_answer = (operation);                                            \
    EXPECT_TRUE(raysteer_answer.has_value()) << raysteer_answer.error().message(); \
  } while (false)
