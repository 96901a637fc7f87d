// value: a slowly changing function of a picture's pixels, kept on a coarse grid.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace raysteer::sim::world {

/// Bilinear between nodes a 64th of the width apart, at most 16 px; constant outside [-border, size + border].
class Smooth {
 public:
  template <class Function>
  Smooth(int width, int height, int border, const Function& value)
      : border_(border),
        step_(std::clamp(width / 64, 2, 16)),
        columns_((width + 2 * border) / step_ + 2),
        rows_((height + 2 * border) / step_ + 2) {
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        nodes_.push_back(static_cast<float>(value(Eigen::Vector2d(column * step_ - border, row * step_ - border))));
      }
    }
  }

  double operator()(double x, double y) const {
    const double column = std::clamp((x + border_) / step_, 0.0, columns_ - 1.001);
    const double row = std::clamp((y + border_) / step_, 0.0, rows_ - 1.001);
    const auto i = static_cast<int>(column);
    const auto j = static_cast<int>(row);
    const float* at = nodes_.data() + j * columns_ + i;
    const double u = column - i;
    const double v = row - j;
    return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[columns_] + u * at[columns_ + 1]);
  }

 private:
  int border_;
  int step_;
  int columns_;
  int rows_;
  std::vector<float> nodes_;
};

}  // namespace raysteer::sim::world
