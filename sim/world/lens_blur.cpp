#include "sim/world/lens_blur.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raysteer::sim::world {

std::vector<float> lens_blur(double sigma_px) {
  const int reach = sigma_px > 0 ? static_cast<int>(std::ceil(4 * sigma_px)) + 1 : 0;
  std::vector<double> half;
  double sum = 0;
  for (int n = 0; n <= reach; ++n) {
    constexpr int kSteps = 512;  // of the response's integral from 0 to pi, smooth and periodic: exact to rounding
    double weight = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double w = (i + 0.5) * std::numbers::pi / kSteps;
      const double s = 4 * std::sin(w / 2) * std::sin(w / 2);
      weight += std::exp(-sigma_px * sigma_px / 2 * (s + s * s / 12)) * std::cos(w * n) / kSteps;
    }
    half.push_back(weight);
    sum += n == 0 ? weight : 2 * weight;
  }
  std::vector<float> weights;
  for (const double weight : half) {
    weights.push_back(static_cast<float>(weight / sum));
  }
  return weights;
}

void blur_row(const std::vector<float>& weights, const float* row, int width, float* out) {
  const int reach = std::min(static_cast<int>(weights.size()) - 1, width / 2);
  const auto clamped = [&](int x) { return row[std::clamp(x, 0, width - 1)]; };
  const auto border = [&](int from, int to) {
    for (int x = from; x < to; ++x) {
      float sum = weights[0] * row[x];
      for (int k = 1; k < static_cast<int>(weights.size()); ++k) {
        sum += weights[static_cast<std::size_t>(k)] * (clamped(x - k) + clamped(x + k));
      }
      out[x] = sum;
    }
  };
  border(0, reach);
  border(width - reach, width);
  for (int x = reach; x < width - reach; ++x) {
    out[x] = weights[0] * row[x];
  }
  for (int k = 1; k <= reach; ++k) {
    const float weight = weights[static_cast<std::size_t>(k)];
    for (int x = reach; x < width - reach; ++x) {
      out[x] += weight * (row[x - k] + row[x + k]);
    }
  }
}

}  // namespace raysteer::sim::world
