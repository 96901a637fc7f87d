// Where stripes end between two rows of pixels, or between the pixels of one row and their neighbours.
#pragma once

#include <cstdint>

#include "calib/decode/code_map.hpp"

namespace raysteer::calib::decode {

/// None of `count` pixels has a code: shadow, mostly, of which there is much and in large pieces.
[[gnu::always_inline]] inline bool nothing_coded(const std::uint16_t* __restrict code, int count) {
  std::uint16_t all = CodeMap::kNoCode;
  for (int i = 0; i < count; ++i) {
    all = static_cast<std::uint16_t>(all & code[i]);
  }
  return all == CodeMap::kNoCode;
}

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

}  // namespace raysteer::calib::decode
