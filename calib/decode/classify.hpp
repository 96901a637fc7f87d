// One row of Gray sums to codes, and to reasons where there is none.
#pragma once

#include <cstdint>

#include "calib/decode/gray_sums.hpp"

namespace raysteer::calib::decode {

/// When a bit is believed.
struct GrayLimits {
  float difference_floor = 0;  ///< variance of p - q, DN^2: floor + slope * (p + q)
  float difference_slope = 0;
  float min_sigma2 = 25;      ///< a difference counts from this many variances on ...
  float min_difference2 = 0;  ///< ... and from this square, DN^2
  float min_contrast = 0;     ///< white - black, DN
  float saturation = 250;     ///< DN
  bool coarse = false;        ///< there are bits with wide stripes, to be classified by direct and global light
  int codes = 0;              ///< number of stripes on the panel
  int width = 0;
};

/// Codes of a row, and reasons or-ed into `mask`. `white` and `black` may be null. `variance` (may be null) receives
/// the variance of p - q at a stripe's border, DN^2.
void classify(const GraySums<std::uint8_t>& sums, const std::uint8_t* white, const std::uint8_t* black,
              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance);
void classify(const GraySums<std::uint16_t>& sums, const std::uint16_t* white, const std::uint16_t* black,
              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance);

}  // namespace raysteer::calib::decode
