#include "host/rig/pixel_floor.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "calib/scene/epipolar.hpp"

namespace raysteer::host::rig {
namespace {

constexpr double kLeastPx = 0.002;
constexpr double kMostPx = 1;
constexpr std::size_t kFewest = 50;
constexpr double kMedianChiSquare = 0.454936;  // of one degree of freedom
constexpr double kOutside = 16;                // squared robust sigma: another surface's pixel, no noise

using Terms = Eigen::Matrix<double, 6, 1>;

struct Disagreement {
  Terms at;           ///< of the quadratic
  double px = 0;      ///< both pixels together
  double stated = 0;  ///< its variance by the matches' own covariances, px^2
};

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Median of squared departures from `smooth`, over their variance with a floor of `floor_px` in each pixel.
double median_square(std::span<const Disagreement> all, const Terms& smooth, double floor_px) {
  std::vector<double> squares;
  std::ranges::transform(all, std::back_inserter(squares), [&](const Disagreement& one) {
    return std::pow(one.px - one.at.dot(smooth), 2) / (one.stated + 2 * floor_px * floor_px);
  });
  return median(std::move(squares));
}

/// Least squares, then without what lies far outside.
Terms quadratic(std::span<const Disagreement> all) {
  Terms smooth = Terms::Zero();
  double within = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 3; ++round) {
    Eigen::Matrix<double, 6, 6> h = 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
    Terms g = Terms::Zero();
    std::vector<double> squares;
    for (const Disagreement& one : all) {
      const double off = one.px - one.at.dot(smooth);
      squares.push_back(off * off);
      if (off * off <= within) {
        h += one.at * one.at.transpose();
        g += one.at * one.px;
      }
    }
    within = kOutside * median(std::move(squares)) / kMedianChiSquare;
    smooth = h.ldlt().solve(g);
  }
  return smooth;
}

}  // namespace

double pixel_floor(const calib::scene::TwoViews& views, std::span<const calib::scene::Match> matches) {
  const std::vector<double> px = calib::scene::epipolar_disagreement(views, calib::scene::ray_pairs(views, matches));
  std::vector<Disagreement> all;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    const double stated = (matches[k].cov_left.trace() + matches[k].cov_right.trace()) / 2;
    if (!std::isfinite(px[k]) || !std::isfinite(stated)) {
      continue;
    }
    const double x = 2 * matches[k].q_left.x() / views.left.width - 1;
    const double y = 2 * matches[k].q_left.y() / views.left.height - 1;
    all.push_back({.at = Terms{{1, x, y, x * x, x * y, y * y}}, .px = px[k], .stated = stated});
  }
  if (all.size() < kFewest) {
    return kUnknownFloorPx;
  }
  const Terms smooth = quadratic(all);
  double low = kLeastPx;
  double high = kMostPx;
  if (median_square(all, smooth, low) <= kMedianChiSquare) {
    return low;
  }
  while (high > 1.01 * low) {
    const double middle = std::sqrt(low * high);
    (median_square(all, smooth, middle) > kMedianChiSquare ? low : high) = middle;
  }
  return high;
}

}  // namespace raysteer::host::rig
