// Matches the rows of a rectified pair that has no calibration: disparities and their noise, no metres.
#pragma once

#include <cstddef>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

/// Disparities of a rectified pair, and how well they are known.
///
/// Rows are matched independently of each other. So a disparity's departure from the mean of those above and below it,
/// divided by sqrt(3/2), is a sample of the matching noise (and of the surface's bend over a pixel, which only adds).
struct RowMatches {
  Image<float> disparity;        ///< u_left - u_right, px; NaN where the left pixel has no partner
  std::size_t matched = 0;       ///< left pixels with a partner
  std::size_t valid_left = 0;    ///< left pixels with a coordinate
  double sigma_px = 0;           ///< 1.4826 MAD of the departures
  double p95_px = 0;             ///< 95th percentile of all absolute departures
  double row_p95_median_px = 0;  ///< the same per row: median over the rows
  double row_p95_worst_px = 0;   ///< and the worst row
  std::size_t rows = 0;          ///< rows with at least 20 departures
};

/// The partner of a left pixel is where the right row, linear between two neighbouring valid pixels, has the same
/// projector column. Where a row shows the column more than once there is none. Both maps have the same height.
/// Errors: kNothingDecoded (no columns), kFrameSize (heights differ), kTooFewMatches (fewer than 100).
Result<RowMatches> match_rows(const decode::CodeMap& left, const decode::CodeMap& right);

}  // namespace raysteer::calib::scene
