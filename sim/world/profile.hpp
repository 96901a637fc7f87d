// value: a pattern that changes along one axis, blurred by the projector, ready to be averaged over a pixel's width.
#pragma once

#include <algorithm>
#include <vector>

namespace raysteer::sim::world {

/// Light along a line of panel pixels: each is a step from i - 0.5 to i + 0.5, nothing is lit outside, and a Gaussian
/// smears it. Held as the integral of a piecewise linear function, so that a mean over any width costs two look-ups.
class Profile {
 public:
  /// `light` of each pixel; `sigma_px` >= kLeastBlurPx.
  Profile(const std::vector<float>& light, double sigma_px);

  /// Mean over [x - width / 2, x + width / 2]; width > 0.
  float mean(double x, double width) const {
    return static_cast<float>((integral(x + width / 2) - integral(x - width / 2)) / width);
  }

 private:
  static constexpr int kNodesPerPx = 8;
  struct Node {
    double integral = 0;  ///< from the profile's beginning, in nodes
    float light = 0;
    float slope = 0;  ///< to the next node
  };

  /// In panel pixels.
  double integral(double x) const {
    const double place = std::clamp((x - begin_px_) * kNodesPerPx, 0.0, last_);
    const auto index = static_cast<int>(place);
    const double past = place - index;
    const Node& node = nodes_[static_cast<std::size_t>(index)];
    return (node.integral + past * (node.light + past * 0.5 * node.slope)) * (1.0 / kNodesPerPx);
  }

  double begin_px_ = 0;
  double last_ = 0;
  std::vector<Node> nodes_;
};

}  // namespace raysteer::sim::world
