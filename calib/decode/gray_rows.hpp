// One row of Gray sums to codes, reasons and the places where stripes end.
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

/// What a border between two neighbouring pixels needs of each.
template <class T>
struct EdgeSource {
  const std::uint16_t* code;
  const T* finest;
  const T* weakest;
  const T* weakest_bit;
  const float* variance;
};

/// Borders in the gaps between pixels a[i] and b[i]. Border n lies between codes n - 1 and n. A gap may hold two: then
/// each pixel has its own nearest.
struct GapRow {
  float* place_a;  ///< of the border nearest to a: 0 at a, 1 at b
  float* place_b;  ///< of the border nearest to b: 0 at a, 1 at b
  float* number_a;
  float* number_b;
  /// Of the place, px^2. kNone: no border here. kLost: a pixel is not decoded, or the codes lie too far apart.
  float* variance_a;
  float* variance_b;
  static constexpr float kNone = 1e30F;  ///< absorbs what is added to it
  static constexpr float kLost = 0;
};

void find_borders(const EdgeSource<std::uint8_t>& a, const EdgeSource<std::uint8_t>& b, int count, const GapRow& gaps);
void find_borders(const EdgeSource<std::uint16_t>& a, const EdgeSource<std::uint16_t>& b, int count,
                  const GapRow& gaps);

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
