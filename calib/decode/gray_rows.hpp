// One row of Gray sums to codes, reasons and the places where stripes end.
#pragma once

#include <cstdint>
#include <limits>

#include "calib/decode/gray_sums.hpp"

namespace raysteer::calib::decode {

/// When a bit is believed.
struct GrayLimits {
  float difference_floor = 0;  ///< variance of p - q, DN^2: floor + slope * (p + q)
  float difference_slope = 0;
  float min_sigma2 = 25;       ///< a difference counts from this many variances on ...
  float min_difference2 = 0;   ///< ... and from this square, DN^2
  float min_contrast = 0;      ///< white - black, DN
  float saturation = 250;      ///< DN
  bool finest_coarse = false;  ///< there are bits with wide stripes to be classified by direct and global light
  int codes = 0;               ///< number of stripes on the panel
  int width = 0;
};

/// Codes of a row, and reasons or-ed into `mask`. `white` and `black` may be null. `variance` (may be null) receives
/// the variance of p - q at a stripe's border, DN^2.
void classify(const GraySums<std::uint8_t>& sums, const std::uint8_t* white, const std::uint8_t* black,
              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance);
void classify(const GraySums<std::uint16_t>& sums, const std::uint16_t* white, const std::uint16_t* black,
              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance);

/// What a border between two neighbouring pixels needs of each.
template <class T>
struct EdgeSource {
  const std::uint16_t* code;
  const T* finest;
  const T* weakest;
  const T* weakest_bit;
  const float* variance;
};

/// Borders in the gaps between pixels a[i] and b[i]. Both pixels have a border here; it is the same one unless the code
/// changes by two.
struct GapRow {
  float* place_a;  ///< of the border of a's stripe, 0 at a to 1 at b
  float* place_b;  ///< of the border of b's stripe, 0 at a to 1 at b
  /// Variance of the place, px^2, with the sign of the code's change from a to b. kSame: the code does not change.
  /// kLost: it changes, but not by one or two stripes, or not by a bit whose difference was kept.
  float* variance_a;
  float* variance_b;
  static constexpr float kSame = std::numeric_limits<float>::infinity();
  static constexpr float kLost = 0;
};

void find_borders(const EdgeSource<std::uint8_t>& a, const EdgeSource<std::uint8_t>& b, int count, const GapRow& gaps);
void find_borders(const EdgeSource<std::uint16_t>& a, const EdgeSource<std::uint16_t>& b, int count,
                  const GapRow& gaps);

/// Coordinates of a row of pixels from the nearest border on either side, each at most `reach` gaps away.
///
/// place_before[k], variance_before[k]: gap k+1 before the pixel (rows or columns), as its nearer pixel b saw it;
/// place_after[k], variance_after[k]: gap k after it, as its nearer pixel a saw it.
struct BorderSearch {
  const float* const* place_before;
  const float* const* variance_before;
  const float* const* place_after;
  const float* const* variance_after;
  int reach;
  float stripe_px;
  float offset_px;
};

/// `value` in projector px and its variance; NaN where the code is kNoCode. A pixel without a border on both sides gets
/// the middle of its stripe and the variance of an even spread over it, stripe^2 / 12.
/// `scratch` holds 4 * count floats.
void place_between_borders(const BorderSearch& search, const std::uint16_t* code, int count, float* value,
                           float* variance, float* scratch);

}  // namespace raysteer::calib::decode
