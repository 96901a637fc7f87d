// value: how much a frame's pixel scatters, and how to find out from the frames themselves.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace raysteer::calib::decode {

/// variance(I) = read^2 + 1/12 + I / electrons_per_dn, DN^2 (algorithms 2.1). The 1/12 is the rounding to whole DN.
struct NoiseModel {
  double read_sigma_dn = 1;
  double electrons_per_dn = std::numeric_limits<double>::infinity();

  double floor() const { return read_sigma_dn * read_sigma_dn + 1.0 / 12.0; }
  double slope() const { return 1.0 / electrons_per_dn; }
  double variance(double dn) const { return floor() + slope() * dn; }
};

/// Collects differences that would be 0 without noise, by signal, and fits the model to their scatter.
///
/// Robust: the largest fifth of the differences of each signal level is left out (edges, JPEG ringing, movement), and
/// the rest scaled to what it is of a Gaussian.
class NoiseEstimate {
 public:
  explicit NoiseEstimate(double full_scale) : full_scale_(full_scale) {}
  /// `difference` has `variances` times the variance of one frame's pixel at level `dn`.
  void add(double dn, double difference, double variances) {
    std::vector<float>& level = levels_[bin(dn)];
    if (level.size() < kMostSamples) {
      level.push_back(static_cast<float>(difference * difference / variances));
    }
  }
  /// The fit; `otherwise` where there is too little to fit.
  NoiseModel fit(const NoiseModel& otherwise) const;

 private:
  static constexpr std::size_t kLevels = 16;
  static constexpr std::size_t kMostSamples = 8192;  ///< gives the scatter to 1 %
  std::size_t bin(double dn) const {
    const double place = dn / full_scale_ * kLevels;
    return place <= 0 ? 0 : place >= kLevels - 1 ? kLevels - 1 : static_cast<std::size_t>(place);
  }

  double full_scale_;
  std::array<std::vector<float>, kLevels> levels_;
};

}  // namespace raysteer::calib::decode
