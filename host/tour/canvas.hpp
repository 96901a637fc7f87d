// bound to its user: a colour picture to draw on: smooth lines, quadrilaterals and a small stroke font.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/image.hpp"
#include "host/report/color.hpp"

namespace raysteer::host::tour {

/// Where text stands against its point: on its baseline, and left of, about or right of it.
enum class Align { kLeft, kMiddle, kRight };

/// Pixel centres at integers.
class Canvas {
 public:
  Canvas(int width, int height, report::Color ground);

  int width() const { return width_; }
  int height() const { return height_; }

  /// A grey picture with its top left pixel at (x, y), white tinted as `light` and black as `dark`.
  void picture(ImageView<const std::uint8_t> grey, int x, int y, report::Color dark, report::Color light);
  /// Round ends; `opacity` 0 to 1.
  void line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness, report::Color color,
            double opacity = 1);
  void dashes(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness, double dash, report::Color color);
  /// Convex, corners in order.
  void fill(const std::array<Eigen::Vector2d, 4>& corners, report::Color color, double opacity);
  /// `height` is that of capitals, px. Characters that the font lacks are drawn as gaps.
  void text(const Eigen::Vector2d& at, std::string_view words, double height, double thickness, report::Color color,
            Align align = Align::kLeft);

  /// Lines, fills and text stay within this rectangle until it is set anew.
  void clip(int x, int y, int width, int height) { clip_ = {x, y, x + width, y + height}; }

  /// RGB, row by row.
  const std::vector<std::uint8_t>& rgb() const { return rgb_; }

 private:
  void blend(int x, int y, report::Color color, double opacity);

  int width_;
  int height_;
  std::array<int, 4> clip_;
  std::vector<std::uint8_t> rgb_;
};

/// Width of a text in px.
double text_width(std::string_view words, double height);

}  // namespace raysteer::host::tour
