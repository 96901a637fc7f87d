#include "calib/synth/profile.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace raysteer::calib::synth {
namespace {

constexpr int kNodesPerPixel = 16;
constexpr double kStep = 1.0 / kNodesPerPixel;
/// Below this width a side of the footprint changes a mean by less than 1e-6 of its contrast, and dividing by it
/// would amplify rounding.
constexpr double kThin = 1e-3;
/// Slopes below this, in light per panel pixel, are rounding and the blur's farthest tail.
constexpr double kFlat = 1e-7;

double gauss_integral(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

}  // namespace

Profile::Profile(const std::vector<double>& pixels, double blur_px) {
  const int count = static_cast<int>(pixels.size());
  const int reach = static_cast<int>(std::ceil(6 * blur_px)) + 1;
  // weights[phase][k]: light that pixel i + k - reach sends to a node `phase` steps right of pixel i's centre
  std::vector<std::vector<double>> weights(kNodesPerPixel);
  for (int phase = 0; phase < kNodesPerPixel; ++phase) {
    for (int k = -reach; k <= reach; ++k) {
      const double from = k - 0.5 - phase * kStep;
      weights[static_cast<std::size_t>(phase)].push_back(gauss_integral((from + 1) / blur_px) -
                                                         gauss_integral(from / blur_px));
    }
  }
  const int first_pixel = -reach - 1;
  const int last_pixel = count + reach;
  start_ = first_pixel;
  nodes_.reserve(static_cast<std::size_t>((last_pixel - first_pixel) * kNodesPerPixel));
  for (int i = first_pixel; i < last_pixel; ++i) {
    const int k0 = std::max(-reach, -i);
    const int k1 = std::min(reach, count - 1 - i);
    for (const std::vector<double>& weight : weights) {
      double value = 0;
      for (int k = k0; k <= k1; ++k) {
        value += weight[static_cast<std::size_t>(k + reach)] * pixels[static_cast<std::size_t>(i + k)];
      }
      nodes_.push_back({value, 0, 0, 0});
    }
  }
  for (std::size_t i = 0; i + 1 < nodes_.size(); ++i) {
    Node& node = nodes_[i];
    Node& next = nodes_[i + 1];
    node.slope = (next.value - node.value) / kStep;
    next.first = node.first + kStep * (node.value + next.value) / 2;
    next.second = node.second + kStep * node.first + kStep * kStep * (2 * node.value + next.value) / 6;
  }
  flat_until_.resize(nodes_.size(), static_cast<int>(nodes_.size()) - 1);
  for (std::size_t i = nodes_.size() - 1; i-- > 0;) {
    flat_until_[i] = std::abs(nodes_[i].slope) < kFlat ? flat_until_[i + 1] : static_cast<int>(i);
  }
}

inline std::size_t Profile::find(double x, double& past) const {
  const double place = std::clamp((x - start_) * kNodesPerPixel, 0.0, static_cast<double>(nodes_.size() - 1));
  const auto index = static_cast<int>(place);
  past = x - start_ - index * kStep;
  return static_cast<std::size_t>(index);
}

inline double Profile::first(double x) const {
  double past = 0;
  const Node& node = nodes_[find(x, past)];
  return node.first + past * (node.value + past * node.slope / 2);
}

inline double Profile::second(double x) const {
  double past = 0;
  const Node& node = nodes_[find(x, past)];
  return node.second + past * (node.first + past * (node.value / 2 + past * (node.slope * (1.0 / 6))));
}

double Profile::mean(double centre, double a, double b) const {
  a = std::abs(a);
  b = std::abs(b);
  if (a < b) {
    std::swap(a, b);
  }
  if (a < kThin) {
    double past = 0;
    const Node& node = nodes_[find(centre, past)];
    return node.value + past * node.slope;
  }
  const double far = (a + b) / 2;
  double past = 0;
  const std::size_t left = find(centre - far, past);
  if (static_cast<int>((centre + far - start_) * kNodesPerPixel) < flat_until_[left]) {
    return nodes_[left].value;  // inside a stripe: most pixels of the coarse patterns
  }
  if (b < kThin) {
    return (first(centre + a / 2) - first(centre - a / 2)) / a;
  }
  const double near = (a - b) / 2;
  return (second(centre + far) - second(centre + near) - second(centre - near) + second(centre - far)) / (a * b);
}

}  // namespace raysteer::calib::synth
