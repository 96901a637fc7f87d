#include "sim/world/profile.hpp"

#include <cmath>
#include <numbers>

namespace raysteer::sim::world {

Profile::Profile(const std::vector<float>& light, double sigma_px) {
  const int count = static_cast<int>(light.size());
  const int reach = static_cast<int>(std::ceil(5 * sigma_px)) + 1;  // a Gaussian's tail beyond 5 sigma is 3e-7
  begin_px_ = -0.5 - reach;
  const int nodes = (count + 2 * reach) * kNodesPerPx + 1;
  last_ = nodes - 1;
  // The blurred profile is a sum of blurred steps where neighbouring pixels differ: few for Gray codes.
  std::vector<double> blurred(static_cast<std::size_t>(nodes), 0.0);
  const int half = reach * kNodesPerPx;
  std::vector<double> step(static_cast<std::size_t>(2 * half) + 1);
  for (int i = -half; i <= half; ++i) {
    step[static_cast<std::size_t>(i + half)] =
        0.5 * std::erfc(-static_cast<double>(i) / (kNodesPerPx * sigma_px * std::numbers::sqrt2));
  }
  step.front() = 0;
  step.back() = 1;
  // kept[i]: by how much the level behind pixel border i rises for good
  std::vector<double> rises(static_cast<std::size_t>(nodes), 0.0);
  for (int border = 0; border <= count; ++border) {
    const double before = border == 0 ? 0 : light[static_cast<std::size_t>(border - 1)];
    const double after = border == count ? 0 : light[static_cast<std::size_t>(border)];
    const double rise = after - before;
    if (rise == 0) {
      continue;
    }
    const int first = border * kNodesPerPx;  // node of the border, less `half`
    for (int i = 0; i < 2 * half; ++i) {
      blurred[static_cast<std::size_t>(first + i)] += rise * step[static_cast<std::size_t>(i)];
    }
    rises[static_cast<std::size_t>(first + 2 * half)] += rise;
  }
  nodes_.resize(static_cast<std::size_t>(nodes));
  double level = 0;
  for (int i = 0; i < nodes; ++i) {
    level += rises[static_cast<std::size_t>(i)];
    nodes_[static_cast<std::size_t>(i)].light = static_cast<float>(blurred[static_cast<std::size_t>(i)] + level);
  }
  for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    Node& next = nodes_[i + 1];
    node.slope = next.light - node.light;
    next.integral = node.integral + 0.5 * (static_cast<double>(node.light) + next.light);
  }
}

}  // namespace raysteer::sim::world
