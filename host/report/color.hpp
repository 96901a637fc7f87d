// pure: colours of the report's maps.
#pragma once

#include <cstdint>
#include <string>

namespace raysteer::host::report {

struct Color {
  std::uint8_t r = 0, g = 0, b = 0;
  bool is_dark() const { return 299 * r + 587 * g + 114 * b < 140 * 1000; }
};

/// 0 to 1 from deep blue over green to yellow, rising in lightness for readers who do not tell hues apart and for grey
/// prints: viridis, sampled at 9 places (van der Walt and Smith 2015, CC0).
Color sequential(double part);

/// 0 to 1 from white to the report's blue: counts and errors, where little ink means little.
Color single(double part);

/// -1 to 1 from blue over white to red: signed values.
Color diverging(double part);

/// "#1f77b4"
std::string to_hex(const Color& color);

}  // namespace raysteer::host::report
