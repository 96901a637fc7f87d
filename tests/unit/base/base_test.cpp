#include <gtest/gtest.h>

#include <type_traits>

#include "hal/base/image.hpp"
#include "hal/base/log.hpp"
#include "hal/base/time.hpp"
#include "hal/base/units.hpp"

namespace raysteer {
namespace {

template <class A, class B>
concept Subtracts = requires(A a, B b) {
  a - b;
};

TEST(Units, do_not_mix_and_do_not_come_from_bare_numbers) {
  static_assert(!std::is_convertible_v<double, Radians>);
  static_assert(!std::is_convertible_v<Meters, Radians>);
  static_assert(!Subtracts<Meters, Radians>);
  static_assert(!std::is_convertible_v<CameraPx, ProjectorPx>);
  static_assert(!Subtracts<DacCode, DacCode>);
  EXPECT_EQ(Meters(3) - Meters(1), Meters(2));
  EXPECT_DOUBLE_EQ(Radians(3) / Radians(2), 1.5);
}

TEST(Time, instants_of_two_clocks_do_not_subtract) {
  static_assert(Subtracts<RigTime, RigTime>);
  static_assert(!Subtracts<RigTime, CameraTime>);
}

TEST(Image, view_keeps_to_its_stride) {
  Image<int> image(4, 3);
  image(3, 2) = 7;
  const ImageView<const int> part(image.data() + 5, 3, 2, 4);
  EXPECT_EQ(part(2, 1), 7);
  EXPECT_TRUE(part.contains(2, 1));
  EXPECT_FALSE(part.contains(3, 1));
  const Image<int> moved = std::move(image);
  EXPECT_TRUE(image.empty());  // NOLINT(bugprone-use-after-move): moved-from is empty by contract
  EXPECT_EQ(moved(3, 2), 7);
}

TEST(EventLog, writes_name_first_and_quotes_only_what_needs_it) {
  EXPECT_EQ(format_event("lut.kept", {{"slot", "B"}, {"took_ms", 41}, {"ok", true}, {"note", "a \"b\"\n"}}),
            "lut.kept slot=B took_ms=41 ok=true note=\"a \\\"b\\\"\\x0a\"");
}

TEST(EventLog, leaves_out_what_is_too_verbose) {
  int lines = 0;
  const EventLog log([&](LogLevel, std::string_view) { ++lines; }, LogLevel::kWarn);
  log.event(LogLevel::kError, "a", {});
  log.event(LogLevel::kInfo, "b", {});
  EXPECT_EQ(lines, 1);
}

}  // namespace
}  // namespace raysteer
