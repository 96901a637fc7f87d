// pure: an array of so many numbers: places, sizes, directions.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "proto/document/toml_table.hpp"

namespace raysteer::proto::document {

/// `count` numbers, each within `range`; without a fallback the key is required. Zeros after a fault: kMissingKey,
/// kBadValue (wrong type or count, out of range; `hint` is added then).
template <std::size_t count>
std::array<double, count> read_numbers(TomlTable& table, std::string_view key, Range<double> range,
                                       const std::array<double, count>* fallback = nullptr,
                                       std::string_view hint = {}) {
  std::array<double, count> values{};
  if (!table.has(key)) {
    table.numbers(key);  // known
    if (fallback == nullptr) {
      table.fault(RCode::kMissingKey, key, "is needed: " + std::to_string(count) + " numbers");
      return values;
    }
    return *fallback;
  }
  const std::vector<double> given = table.numbers(key);
  if (given.size() != count) {
    table.fault(RCode::kBadValue, key,
                "must be " + std::to_string(count) + " numbers, got " + std::to_string(given.size()));
    return values;
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!(given[i] >= range.least && given[i] <= range.most)) {
      table.fault(RCode::kBadValue, key,
                  "has " + std::to_string(given[i]) + ", which must be " + std::to_string(range.least) + " to " +
                      std::to_string(range.most) + (hint.empty() ? "" : "; " + std::string(hint)));
      return {};
    }
    values[i] = given[i];
  }
  return values;
}

}  // namespace raysteer::proto::document
