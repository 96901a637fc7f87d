// Coordinates of the pixels between two borders.
#pragma once

#include <cstdint>

#include "calib/decode/find_borders.hpp"

namespace raysteer::calib::decode {

/// Coordinates of a row of pixels from the nearest border on either side, each at most `reach` gaps away.
struct BorderSearch {
  const GapRow* before;  ///< [k]: gap k + 1 before each pixel
  const GapRow* after;   ///< [k]: gap k after each pixel
  int reach;
  float stripe_px;
  float offset_px;
  const float* border;    ///< place of border n in stripes; null: n
  int borders;            ///< how many of them
  float excess_variance;  ///< of a border's place, stripes^2
};

/// `value` in projector px and its variance; NaN where the code is kNoCode. A pixel without a border on both sides gets
/// the middle of its stripe and the variance of an even spread over it, stripe^2 / 12.
void place_between_borders(const BorderSearch& search, const std::uint16_t* code, int count, float* value,
                           float* variance);

}  // namespace raysteer::calib::decode
