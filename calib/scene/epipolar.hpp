// How far matches are from agreeing with a pair's calibration, and how much of it is noise.
#pragma once

#include <span>
#include <vector>

#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::calib::scene {

/// Signed disagreement of each match, px: sqrt(2) x Sampson's distance on undistorted positions times the mean focal
/// length. Equals the difference of rows after rectification, and favours neither view. NaN where a lens model ends.
std::vector<double> epipolar_disagreement(const TwoViews& views, std::span<const Match> matches);

/// A square of the left image.
struct EpipolarCell {
  int column = 0, row = 0;  ///< cell's corner is (column, row) * cell_px
  int matches = 0;
  double median_px = 0;  ///< of the disagreement
};

struct EpipolarAnalysis {
  double sigma_px = 0;        ///< 1.4826 MAD of all matches, nothing left out
  double within_cell_px = 0;  ///< 1.4826 MAD about each cell's own plane, corrected for the plane's 3 parameters
  double systematic_px = 0;   ///< RMS of the cells' medians about zero, their own noise taken off
  std::vector<EpipolarCell> cells;
};

/// Cells hold a smooth systematic part of a lens or pose error and still some hundred matches.
inline constexpr int kEpipolarCellPx = 32;

/// Errors: kTooFewMatches (fewer than 100).
Result<EpipolarAnalysis> analyse_epipolar(std::span<const Match> matches, std::span<const double> disagreement,
                                          int cell_px = kEpipolarCellPx);

}  // namespace raysteer::calib::scene
