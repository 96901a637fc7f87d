#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include "hal/base/nearest.hpp"
#include "proto/board/board.hpp"

namespace raysteer::proto::board {
namespace {

constexpr std::array<std::string_view, 9> kDevices{"mirror",  "projector", "left",  "right", "cameras",
                                                   "trigger", "interlock", "store", "clock"};

// The whole of `text` as a number.
template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

// Cuts what follows the last `mark` off `text`.
std::optional<std::string_view> cut(std::string_view& text, char mark) {
  const std::size_t at = text.rfind(mark);
  if (at == std::string_view::npos) {
    return std::nullopt;
  }
  const std::string_view tail = text.substr(at + 1);
  text = text.substr(0, at);
  return tail;
}

bool is_word(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, [](char c) { return (c >= 'a' && c <= 'z') || c == '-'; });
}

}  // namespace

Result<Fault> read_fault(std::string_view text) {
  const auto bad = [&](const std::string& why) {
    return fail(RCode::kBadValue, "fault '" + std::string(text) + "': " + why +
                                      "; written DEVICE.WHAT[=AMOUNT][@SECONDSs][*TIMES], as in left.drop@2s*3");
  };
  Fault fault;
  std::string_view rest = text;
  if (const auto times = cut(rest, '*')) {
    const std::optional<int> value = number<int>(*times);
    if (!value || *value < 0 || *value > 1'000'000) {
      return bad("'" + std::string(*times) + "' is not how often (1 to 1000000, 0: for ever)");
    }
    fault.times = *value;
  }
  if (auto at = cut(rest, '@')) {
    if (!at->ends_with('s') || at->ends_with("ms")) {
      return bad("'" + std::string(*at) + "' is not when, in seconds with their unit (2s, 0.5s)");
    }
    at->remove_suffix(1);
    const std::optional<double> value = number<double>(*at);
    if (!value || !(*value >= 0) || !(*value <= 1e6)) {
      return bad("'" + std::string(*at) + "' is no number of seconds");
    }
    fault.at_s = *value;
  }
  if (const auto amount = cut(rest, '=')) {
    const std::optional<double> value = number<double>(*amount);
    if (!value || !std::isfinite(*value)) {
      return bad("'" + std::string(*amount) + "' is no amount");
    }
    fault.amount = *value;
  }
  const auto what = cut(rest, '.');
  if (!what || !is_word(*what)) {
    return bad("no device and word with a '.' between");
  }
  if (std::ranges::find(kDevices, rest) == kDevices.end()) {
    std::string known = "'" + std::string(rest) + "' is no device" + did_you_mean(rest, kDevices) + " Known:";
    for (const std::string_view device : kDevices) {
      known += " " + std::string(device);
    }
    return bad(known);
  }
  fault.device = rest;
  fault.what = *what;
  return fault;
}

}  // namespace raysteer::proto::board
