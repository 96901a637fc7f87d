// value: what an operation that can fail returns.
//
// Spelled like C++23's std::expected, so that it can become that. No exceptions: their cost in a tick has no bound.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "hal/base/rcode.hpp"

namespace raysteer {

/// What went wrong. `rcode` names the fault and carries its sentence, cause and remedy (`raysteer explain`);
/// `note` says what was expected and what came, and is filled only by code that is not real-time.
struct Error {
  RCode rcode{};
  std::int64_t detail = 0;  ///< one integer: errno, register, frame number
  std::string note;
  const char* file = "";
  int line = 0;

  ErrorCode code() const { return explain(rcode).code; }
  /// "a frame file is missing: left/07.jpg (frame 7 of camera 'left')"
  std::string message() const;
};

/// Makes an error, stamped with the place it was made.
[[nodiscard]] Error fail(RCode rcode, std::string note = {}, std::int64_t detail = 0,
                         const char* file = __builtin_FILE(), int line = __builtin_LINE());

/// Adds context while passing an error upward: "session.toml: " + note.
[[nodiscard]] Error with_context(Error error, std::string_view context);

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  T& value() & { return std::get<0>(state_); }
  const T& value() const& { return std::get<0>(state_); }
  T&& value() && { return std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  Error& error() & { return std::get<1>(state_); }
  const Error& error() const& { return std::get<1>(state_); }
  Error&& error() && { return std::get<1>(std::move(state_)); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}

  bool has_value() const { return !error_.has_value(); }
  explicit operator bool() const { return has_value(); }
  Error& error() & { return *error_; }
  const Error& error() const& { return *error_; }
  Error&& error() && { return std::move(*error_); }

 private:
  std::optional<Error> error_;
};

using Status = Result<void>;
inline Status ok() { return {}; }

/// Prints what failed and aborts; for our own bugs only, also in release builds.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace raysteer

/// Returns the error of `expression` from this function, if it has one.
#define RAYSTEER_TRY(expression)                                               \
  do {                                                                         \
    if (auto&& raysteer_status = (expression); !raysteer_status.has_value()) { \
      return std::move(raysteer_status).error();                               \
    }                                                                          \
  } while (false)

/// Our own invariant: aborts when it does not hold.
#define RAYSTEER_CHECK(condition)                               \
  do {                                                          \
    if (!(condition)) {                                         \
      ::raysteer::check_failed(#condition, __FILE__, __LINE__); \
    }                                                           \
  } while (false)
