#include "calib/bake/test_card.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace raysteer::calib::bake {
namespace {

constexpr double kFrame = 0.004;  // metres
constexpr double kLine = 0.0015;  // half the width of the cross
constexpr double kGround = 0.22;  // light of the card's ground

/// Distance to the nearest multiple of `step`.
double to_multiple(double value, double step) { return std::abs(value - step * std::round(value / step)); }

/// Ticks along a side: `s` runs along it, `depth` inwards. Each centimetre; longer each 5.
bool tick(double s, double depth) {
  const double length = to_multiple(s, 0.05) < 0.003 ? 0.016 : 0.009;
  return depth < length && to_multiple(s, 0.01) < 0.001;
}

}  // namespace

double TestCard::light(const Eigen::Vector2d& content) const {
  const double u = content.x();
  const double v = content.y();
  const double from_side = std::min(u, width_m - u);
  const double from_end = std::min(v, height_m - v);
  if (from_side < 0 || from_end < 0) {
    return 0;
  }
  if (std::min(from_side, from_end) < kFrame) {
    return 1;
  }
  if (tick(u, from_end) || tick(v, from_side)) {
    return 0.9;
  }
  // Corner marks: quarter discs.
  if (std::hypot(from_side, from_end) < 0.035 && std::hypot(from_side, from_end) > 0.030) {
    return 1;
  }
  const double x = u - 0.5 * width_m;
  const double y = v - 0.5 * height_m;
  const double radius = std::hypot(x, y);
  if (std::abs(radius - 0.10) < 0.002 || (radius < 0.02 && std::min(std::abs(x), std::abs(y)) < kLine)) {
    return 1;
  }
  if (std::min(to_multiple(x, 0.05), to_multiple(y, 0.05)) < 0.5 * kLine) {
    return 0.55;
  }
  return kGround;
}

Image<std::uint8_t> panel_picture(const TestCard& card, const ContentMap& map, int panel_width, int panel_height,
                                  double gamma) {
  constexpr int kSide = 6;
  Image<std::uint8_t> picture(panel_width, panel_height);
  const auto row_of = [&](int y) {
    std::vector<std::optional<Eigen::Vector2d>> row(static_cast<std::size_t>(panel_width) + 1);
    for (int x = 0; x <= panel_width; ++x) {
      row[static_cast<std::size_t>(x)] = map(Eigen::Vector2d(x - 0.5, y - 0.5));
    }
    return row;
  };
  auto above = row_of(0);
  for (int y = 0; y < panel_height; ++y) {
    auto below = row_of(y + 1);
    for (int x = 0; x < panel_width; ++x) {
      const auto i = static_cast<std::size_t>(x);
      if (!above[i] || !above[i + 1] || !below[i] || !below[i + 1]) {
        continue;
      }
      const Eigen::Vector2d origin = *above[i];
      const Eigen::Vector2d right = 0.5 * (*above[i + 1] - *above[i] + *below[i + 1] - *below[i]);
      const Eigen::Vector2d down = 0.5 * (*below[i] - *above[i] + *below[i + 1] - *above[i + 1]);
      const double reach = right.norm() + down.norm();
      if (origin.x() < -reach || origin.y() < -reach || origin.x() > card.width_m + reach ||
          origin.y() > card.height_m + reach) {
        continue;
      }
      double light = 0;
      for (int v = 0; v < kSide; ++v) {
        for (int u = 0; u < kSide; ++u) {
          light += card.light(origin + (u + 0.5) / kSide * right + (v + 0.5) / kSide * down);
        }
      }
      picture(x, y) = static_cast<std::uint8_t>(std::lround(255 * std::pow(light / (kSide * kSide), 1 / gamma)));
    }
    above = std::move(below);
  }
  return picture;
}

}  // namespace raysteer::calib::bake
