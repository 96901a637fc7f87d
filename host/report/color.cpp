#include "host/report/color.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace raysteer::host::report {
namespace {

Color mix(std::span<const Color> stops, double part) {
  const double place = std::clamp(std::isfinite(part) ? part : 0.0, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const auto index = std::min(static_cast<std::size_t>(place), stops.size() - 2);
  const double rest = place - static_cast<double>(index);
  const auto channel = [&](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(from + rest * (to - from)));
  };
  const Color& a = stops[index];
  const Color& b = stops[index + 1];
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

}  // namespace

Color sequential(double part) {
  static constexpr Color kStops[] = {{68, 1, 84},    {71, 44, 122}, {59, 81, 139},  {44, 113, 142}, {33, 144, 141},
                                     {39, 173, 129}, {92, 200, 99}, {170, 220, 50}, {253, 231, 37}};
  return mix(kStops, part);
}

Color single(double part) {
  static constexpr Color kStops[] = {{247, 249, 252}, {198, 219, 239}, {107, 163, 214}, {33, 102, 172}, {8, 48, 107}};
  return mix(kStops, part);
}

Color diverging(double part) {
  static constexpr Color kStops[] = {{33, 102, 172}, {146, 197, 222}, {250, 250, 250}, {244, 165, 130}, {178, 24, 43}};
  return mix(kStops, (part + 1) / 2);
}

std::string to_hex(const Color& color) { return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b); }

}  // namespace raysteer::host::report
