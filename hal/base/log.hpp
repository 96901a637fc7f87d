// shared: events, not prose. "lut.kept slot=B crc=0x77aa took_ms=41": a name, then typed fields.
#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

namespace raysteer {

enum class LogLevel {
  kError,  ///< someone must act
  kWarn,   ///< we coped
  kInfo,   ///< state changed
  kDebug,
};

struct LogField {
  std::string_view name;
  std::variant<std::int64_t, double, bool, std::string_view> value;

  template <class Integer>
  requires std::is_integral_v<Integer> LogField(std::string_view field, Integer number)
      : name(field), value(to_value(number)) {}
  LogField(std::string_view field, double number) : name(field), value(number) {}
  LogField(std::string_view field, std::string_view text) : name(field), value(text) {}
  LogField(std::string_view field, const char* text) : name(field), value(std::string_view(text)) {}
  LogField(std::string_view field, const std::string& text) : name(field), value(std::string_view(text)) {}

 private:
  template <class Integer>
  static std::variant<std::int64_t, double, bool, std::string_view> to_value(Integer number) {
    if constexpr (std::is_same_v<Integer, bool>) {
      return number;
    } else {
      return static_cast<std::int64_t>(number);
    }
  }
};

/// One event as one line; text with blanks, quotes or control characters is quoted and escaped.
std::string format_event(std::string_view name, std::initializer_list<LogField> fields);

/// Where events go. Handed to whoever logs; there is no global log. Not for the real-time thread.
class EventLog {
 public:
  using Sink = std::function<void(LogLevel, std::string_view line)>;
  explicit EventLog(Sink sink, LogLevel most_verbose = LogLevel::kInfo)
      : sink_(std::move(sink)), most_verbose_(most_verbose) {}

  void event(LogLevel level, std::string_view name, std::initializer_list<LogField> fields) const {
    if (sink_ && level <= most_verbose_) {
      sink_(level, format_event(name, fields));
    }
  }

 private:
  Sink sink_;
  LogLevel most_verbose_;
};

}  // namespace raysteer
