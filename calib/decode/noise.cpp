#include "calib/decode/noise.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::calib::decode {
namespace {

constexpr double kKept = 0.8;
/// Mean square of a standard Gaussian whose largest fifth is left out: 1 - 2 z phi(z) / 0.8 at z = 1.2816.
constexpr double kKeptVariance = 0.4377;
constexpr std::size_t kFewestSamples = 200;

}  // namespace

NoiseModel NoiseEstimate::fit(const NoiseModel& otherwise) const {
  // Straight line variance(dn), weighted: a variance from n samples scatters by itself times sqrt(2 / n).
  double sw = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t k = 0; k < kLevels; ++k) {
    std::vector<float> squares = levels_[k];
    if (squares.size() < kFewestSamples) {
      continue;
    }
    const std::size_t kept = static_cast<std::size_t>(kKept * static_cast<double>(squares.size()));
    std::nth_element(squares.begin(), squares.begin() + static_cast<std::ptrdiff_t>(kept), squares.end());
    double sum = 0;
    for (std::size_t i = 0; i < kept; ++i) {
      sum += squares[i];
    }
    const double variance = std::max(sum / static_cast<double>(kept) / kKeptVariance, 1.0 / 12.0);
    const double dn = (static_cast<double>(k) + 0.5) / kLevels * full_scale_;
    const double w = static_cast<double>(kept) / (variance * variance);
    sw += w;
    sx += w * dn;
    sy += w * variance;
    sxx += w * dn * dn;
    sxy += w * dn * variance;
  }
  if (sw == 0) {
    return otherwise;
  }
  const double determinant = sw * sxx - sx * sx;
  double slope = determinant > 1e-9 * sw * sxx ? (sw * sxy - sx * sy) / determinant : 0;
  double floor = (sy - slope * sx) / sw;
  if (slope < 0) {
    slope = 0;
    floor = sy / sw;
  } else if (floor < 1.0 / 12.0) {
    floor = 1.0 / 12.0;
    slope = std::max(0.0, (sxy - floor * sx) / sxx);
  }
  return {.read_sigma_dn = std::sqrt(std::max(0.0, floor - 1.0 / 12.0)),
          .electrons_per_dn = slope > 0 ? 1 / slope : std::numeric_limits<double>::infinity()};
}

}  // namespace raysteer::calib::decode
