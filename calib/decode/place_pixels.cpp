#include "calib/decode/place_pixels.hpp"

#include <limits>

#include "calib/decode/code_map.hpp"
#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// Pixels placed together: what is found on both sides of them, 6 floats each, stays in the first-level cache, and a
/// far border of one does not send all of a row searching.
constexpr int kPiece = 256;

/// What the nearest gap shows; returns whether some pixel still has nothing.
[[gnu::always_inline]] inline bool take_gap(const float* __restrict place, const float* __restrict number,
                                            const float* __restrict variance, float shift, int count,
                                            float* __restrict found_place, float* __restrict found_number,
                                            float* __restrict found_variance) {
  int open = 0;
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    found_place[i] = place[i] + shift;
    found_number[i] = number[i];
    found_variance[i] = variance[i];
    open |= variance[i] == GapRow::kNone ? 1 : 0;
  }
  return open != 0;
}

/// Takes gap k where nothing was found yet; returns whether some pixel still has nothing.
[[gnu::always_inline]] inline bool search_gap(const float* __restrict place, const float* __restrict number,
                                              const float* __restrict variance, float shift, int count,
                                              float* __restrict found_place, float* __restrict found_number,
                                              float* __restrict found_variance) {
  int open = 0;
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const bool take = found_variance[i] == GapRow::kNone;
    const float here = take ? variance[i] : found_variance[i];
    found_place[i] = take ? place[i] + shift : found_place[i];
    found_number[i] = take ? number[i] : found_number[i];
    found_variance[i] = here;
    open |= here == GapRow::kNone ? 1 : 0;
  }
  return open != 0;
}

/// Coordinates of `count` pixels, at most kPiece, from pixel `first` of the row on.
[[gnu::always_inline]] inline void place_piece(const BorderSearch& search, int first,
                                               const std::uint16_t* __restrict code, int count, float* __restrict value,
                                               float* __restrict variance) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  if (nothing_coded(code, count)) {
    for (int i = 0; i < count; ++i) {
      value[i] = kNan;
      variance[i] = kNan;
    }
    return;
  }
  alignas(64) float side[6][kPiece];
  for (int k = 0; k < search.reach; ++k) {
    const float shift = -1.0F - static_cast<float>(k);
    const GapRow& gap = search.before[k];
    const bool open = k == 0 ? take_gap(gap.place_b + first, gap.number_b + first, gap.variance_b + first, shift, count,
                                        side[0], side[1], side[2])
                             : search_gap(gap.place_b + first, gap.number_b + first, gap.variance_b + first, shift,
                                          count, side[0], side[1], side[2]);
    if (!open) {
      break;
    }
  }
  for (int k = 0; k < search.reach; ++k) {
    const auto shift = static_cast<float>(k);
    const GapRow& gap = search.after[k];
    const bool open = k == 0 ? take_gap(gap.place_a + first, gap.number_a + first, gap.variance_a + first, shift, count,
                                        side[3], side[4], side[5])
                             : search_gap(gap.place_a + first, gap.number_a + first, gap.variance_a + first, shift,
                                          count, side[3], side[4], side[5]);
    if (!open) {
      break;
    }
  }
  if (search.border != nullptr) {
    for (int k : {1, 4}) {
      for (int i = 0; i < count; ++i) {
        // Where nothing was found the number is none; what comes of it is not used.
        const int n = greater(lesser(static_cast<int>(side[k][i]), search.borders - 1), 0);
        side[k][i] = search.border[n];
      }
    }
  }
  const float stripe = search.stripe_px;
  const float origin = -search.offset_px - 0.5F;
  const float excess = search.excess_variance;
  const float* __restrict place_before = side[0];
  const float* __restrict border_before = side[1];
  const float* __restrict variance_before = side[2];
  const float* __restrict place_after = side[3];
  const float* __restrict border_after = side[4];
  const float* __restrict variance_after = side[5];
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const float vb = variance_before[i];
    const float va = variance_after[i];
    const float span = place_after[i] - place_before[i];
    const float rise = border_after[i] - border_before[i];
    // Not between two borders: a side is missing, or the surface turns here and shows the same border twice. Borders
    // that say less than the stripe itself are not asked either.
    const int bracketed = (vb > 0 ? 1 : 0) & (va > 0 ? 1 : 0) & (vb < GapRow::kNone ? 1 : 0) &
                          (va < GapRow::kNone ? 1 : 0) & (rise != 0 ? 1 : 0);
    const float t = -place_before[i] / greater(span, 1e-3F);
    const float slope = rise / greater(span, 0.1F);
    const float weight_before = (1 - t) * (1 - t);
    const float weight_after = t * t;
    const float spread =
        slope * slope * (weight_before * vb + weight_after * va) + excess * (weight_before + weight_after);
    constexpr float kEvenSpread = 1.0F / 12.0F;
    const int between = bracketed & (spread < kEvenSpread ? 1 : 0);
    const float middle = static_cast<float>(code[i]) + 0.5F;
    const float number = between != 0 ? border_before[i] + t * rise : middle;
    const float scatter = between != 0 ? spread : kEvenSpread;
    const float coded = code[i] != CodeMap::kNoCode ? 0.0F : kNan;
    value[i] = number * stripe + origin + coded;
    variance[i] = scatter * stripe * stripe + coded;
  }
}

}  // namespace

RAYSTEER_CLONES void place_between_borders(const BorderSearch& search, const std::uint16_t* code, int count,
                                           float* value, float* variance) {
  for (int first = 0; first < count; first += kPiece) {
    place_piece(search, first, code + first, lesser(kPiece, count - first), value + first, variance + first);
  }
}

}  // namespace raysteer::calib::decode
