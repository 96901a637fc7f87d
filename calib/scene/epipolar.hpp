// How far matches are from agreeing with a pair's calibration, and how much of it is noise.
#pragma once

#include <span>
#include <vector>

#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::calib::scene {

/// Signed disagreement of each pair of rays, px: sqrt(2) x Sampson's distance x the mean focal length. Equals the
/// difference of rows after rectification, and favours neither view. NaN where a ray is.
std::vector<double> epipolar_disagreement(const TwoViews& views, std::span<const RayPair> rays);

/// A square of the left image.
struct EpipolarCell {
  int column = 0, row = 0;  ///< cell's corner is (column, row) * cell_px
  int matches = 0;
  double median_px = 0;  ///< of the disagreement
};

struct EpipolarAnalysis {
  double sigma_px = 0;            ///< 1.4826 MAD of all matches, nothing left out
  double within_cell_px = 0;      ///< 1.4826 MAD about each cell's own plane, corrected for the plane's 3 parameters
  double systematic_px = 0;       ///< RMS of the cells' medians about zero
  std::size_t within_1_5_px = 0;  ///< matches whose disagreement is below 1.5 px: the reference's gate
  std::vector<EpipolarCell> cells;
};

/// Small enough that a lens or pose error is a plane in it, large enough (some hundred matches) that a plane fits no
/// noise away.
inline constexpr int kEpipolarCellPx = 32;

/// Errors: kTooFewMatches (fewer than 100).
Result<EpipolarAnalysis> analyse_epipolar(std::span<const Match> matches, std::span<const double> disagreement,
                                          int cell_px = kEpipolarCellPx);

/// 1.4826 x the median absolute deviation from the median; NaNs are left out. 0 of nothing.
double robust_sigma(std::span<const double> values);

}  // namespace raysteer::calib::scene
