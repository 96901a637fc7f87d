// pure: values as TOML text that reads back as the same values.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace raysteer::proto::document {

/// A quoted string, escaped where it must be.
std::string quoted(std::string_view text);
/// The shortest text that reads back as the same number.
std::string number(double value);
std::string number(std::int64_t value);
/// "[1, 2.5]"
std::string array(std::span<const double> values);

}  // namespace raysteer::proto::document
