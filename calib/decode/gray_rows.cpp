#include "calib/decode/gray_rows.hpp"

#include <algorithm>
#include <cmath>

#include "calib/decode/code_map.hpp"
#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// The bit that border n (between codes n - 1 and n) changes, as GraySums::weakest_bit labels it.
[[gnu::always_inline]] inline int border_label(int n) { return std::min((n & -n) >> 1, kMostLabel); }

template <class T>
[[gnu::always_inline]] inline void classify_row(const GraySums<T>& sums, const T* __restrict white,
                                                const T* __restrict black, const GrayLimits& limits,
                                                std::uint16_t* __restrict code, std::uint8_t* __restrict mask,
                                                float* __restrict variance) {
  const GrayLimits l = limits;
  const T* __restrict low = sums.code_low;
  const T* __restrict high = sums.code_high;
  const T* __restrict weakest = sums.weakest;
  const T* __restrict weakest_bit = sums.weakest_bit;
  const T* __restrict second = sums.second;
  const T* __restrict direct = sums.direct;
  const T* __restrict unlit = sums.unlit;
  const T* __restrict coarse_unlit = sums.coarse_unlit;
  const T* __restrict coarse_lit = sums.coarse_lit;
  for (int i = 0; i < l.width; ++i) {
    unsigned value = low[i];
    if constexpr (sizeof(T) == 1) {
      value |= static_cast<unsigned>(high[i]) << 8U;
    }
    value ^= value >> 1U;
    value ^= value >> 2U;
    value ^= value >> 4U;
    value ^= value >> 8U;
    const int c = static_cast<int>(value);

    const float d = direct[i];
    const float dark = unlit[i];
    const float variance_here = l.difference_floor + l.difference_slope * (d + 2 * dark);
    const float least2 = std::max(l.min_sigma2 * variance_here, l.min_difference2);
    const float w1 = weakest[i];
    const float w2 = second[i];

    // The pixel lies on the border whose bit is weak: either code is right. Any other weak bit is a guess.
    const int even = (c + 1) & ~1;
    const bool at_border = weakest_bit[i] == border_label(even);
    bool ambiguous = (w1 * w1 < least2 && !at_border) || w2 * w2 < least2;
    const bool weak = d * d < least2;
    bool shadow = false;
    float ambient = 0;
    if (white != nullptr) {
      const float contrast = static_cast<float>(white[i]) - static_cast<float>(black[i]);
      shadow = contrast * std::abs(contrast) < least2 || contrast < l.min_contrast;
      ambient = black[i];
    }
    if (l.finest_coarse) {
      // Xu and Aliaga: with little global light (d > g) the sign decides; with much, only values that direct or global
      // light alone could not have made. All coarse bits pass when their extremes do.
      const float g = 2 * (dark - ambient);
      const float lowest = static_cast<float>(coarse_unlit[i]) - ambient;
      const float highest = static_cast<float>(coarse_lit[i]) - ambient;
      ambiguous = ambiguous || (d <= g && !(lowest <= d && highest >= g));
    }
    const bool outside = c >= l.codes;
    const bool saturated = weak && dark >= l.saturation;
    const unsigned reasons = (shadow ? unsigned{kShadow} : 0U) | (weak ? unsigned{kLowModulation} : 0U) |
                             (saturated ? unsigned{kSaturated} : 0U) | (ambiguous ? unsigned{kAmbiguous} : 0U) |
                             (outside && !ambiguous && !weak && !shadow ? unsigned{kOutside} : 0U);
    mask[i] = static_cast<std::uint8_t>(mask[i] | reasons);
    code[i] = reasons == 0 ? static_cast<std::uint16_t>(c) : CodeMap::kNoCode;
    if (variance != nullptr) {
      variance[i] = variance_here;
    }
  }
}

/// The nearest borders in each gap, seen from either pixel.
///
/// The code without its last bit, h, steps at even borders 2h; bit 0 changes at odd ones. So a border is numbered by
/// what changes and not by the codes before and after: an undecided bit 0 leaves the others where they are.
template <class T>
[[gnu::always_inline]] inline void find_row_borders(const EdgeSource<T>& a, const EdgeSource<T>& b, int count,
                                                    const GapRow& gaps) {
  const std::uint16_t* __restrict code_a = a.code;
  const std::uint16_t* __restrict code_b = b.code;
  const T* __restrict finest_a = a.finest;
  const T* __restrict finest_b = b.finest;
  const T* __restrict weakest_a = a.weakest;
  const T* __restrict weakest_b = b.weakest;
  const T* __restrict label_a = a.weakest_bit;
  const T* __restrict label_b = b.weakest_bit;
  const float* __restrict noise_a = a.variance;
  const float* __restrict noise_b = b.variance;
  float* __restrict out_place_a = gaps.place_a;
  float* __restrict out_place_b = gaps.place_b;
  float* __restrict out_number_a = gaps.number_a;
  float* __restrict out_number_b = gaps.number_b;
  float* __restrict out_variance_a = gaps.variance_a;
  float* __restrict out_variance_b = gaps.variance_b;
  for (int i = 0; i < count; ++i) {
    const int ca = code_a[i];
    const int cb = code_b[i];
    const int ha = ca >> 1;
    const int hb = cb >> 1;
    const int step = hb - ha;
    const bool lost = ca == CodeMap::kNoCode || cb == CodeMap::kNoCode || step > 1 || step < -1;
    const float noise = 0.5F * (noise_a[i] + noise_b[i]);

    // Even border: some bit but the last; its difference is the weakest at both pixels.
    const int even = 2 * std::max(ha, hb);
    const float even_a = weakest_a[i];
    const float even_b = weakest_b[i];
    const int even_label = border_label(even);
    const bool has_even = step != 0 && label_a[i] == even_label && label_b[i] == even_label && even_a + even_b > 0;
    // Odd border: the last bit. Where h steps too, the codes' parity says on which side of the even border it lies.
    const bool has_odd = ((ca ^ ha ^ cb ^ hb) & 1) != 0;
    const bool at_a = step == 0 || (step > 0) == ((ca & 1) == 0);
    const int odd = 2 * (at_a ? ha : hb) + 1;
    const float odd_a = finest_a[i];
    const float odd_b = finest_b[i];

    // The difference falls from its value at a to its negative at b: linear between, 0 at the border.
    const float even_scale = 1.0F / std::max(even_a + even_b, 1.0F);
    const float odd_scale = 1.0F / std::max(odd_a + odd_b, 1.0F);
    const float fe = even_a * even_scale;
    const float fo = odd_a * odd_scale;
    const float ve = noise * even_scale * even_scale * (fe * fe + (1 - fe) * (1 - fe));
    const float vo = noise * odd_scale * odd_scale * (fo * fo + (1 - fo) * (1 - fo));
    const bool even_first = has_even && (!has_odd || fe <= fo);
    const bool even_last = has_even && (!has_odd || fe > fo);
    const bool none = !has_even && !has_odd;
    out_place_a[i] = even_first ? fe : fo;
    out_number_a[i] = static_cast<float>(even_first ? even : odd);
    out_variance_a[i] = lost ? GapRow::kLost : none ? GapRow::kNone : even_first ? ve : vo;
    out_place_b[i] = even_last ? fe : fo;
    out_number_b[i] = static_cast<float>(even_last ? even : odd);
    out_variance_b[i] = lost ? GapRow::kLost : none ? GapRow::kNone : even_last ? ve : vo;
  }
}

/// Takes gap k where nothing was found yet; returns whether some pixel still has nothing.
[[gnu::always_inline]] inline bool search_gap(const float* __restrict place, const float* __restrict number,
                                              const float* __restrict variance, float shift, int count,
                                              float* __restrict found_place, float* __restrict found_number,
                                              float* __restrict found_variance) {
  int open = 0;
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

[[gnu::always_inline]] inline void place_row(const BorderSearch& search, const std::uint16_t* __restrict code,
                                             int count, float* __restrict value, float* __restrict variance,
                                             float* __restrict scratch) {
  float* __restrict side[6];
  for (int k = 0; k < 6; ++k) {
    side[k] = scratch + k * static_cast<std::ptrdiff_t>(count);
  }
  std::fill(side[2], side[2] + count, GapRow::kNone);
  std::fill(side[5], side[5] + count, GapRow::kNone);
  for (int k = 0; k < search.reach; ++k) {
    const float shift = -1.0F - static_cast<float>(k);
    const GapRow& gap = search.before[k];
    if (!search_gap(gap.place_b, gap.number_b, gap.variance_b, shift, count, side[0], side[1], side[2])) {
      break;
    }
  }
  for (int k = 0; k < search.reach; ++k) {
    const float shift = static_cast<float>(k);
    const GapRow& gap = search.after[k];
    if (!search_gap(gap.place_a, gap.number_a, gap.variance_a, shift, count, side[3], side[4], side[5])) {
      break;
    }
  }
  const float stripe = search.stripe_px;
  const float origin = -search.offset_px - 0.5F;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const float* __restrict place_before = side[0];
  const float* __restrict number_before = side[1];
  const float* __restrict variance_before = side[2];
  const float* __restrict place_after = side[3];
  const float* __restrict number_after = side[4];
  const float* __restrict variance_after = side[5];
  for (int i = 0; i < count; ++i) {
    const float vb = variance_before[i];
    const float va = variance_after[i];
    const float span = place_after[i] - place_before[i];
    const float from = search.border == nullptr ? number_before[i] : search.border[static_cast<int>(number_before[i])];
    const float to = search.border == nullptr ? number_after[i] : search.border[static_cast<int>(number_after[i])];
    const float rise = to - from;
    // Not between two borders: a side is missing, or the surface turns here and shows the same border twice.
    const bool between =
        vb > 0 && va > 0 && vb < GapRow::kNone && va < GapRow::kNone && number_before[i] != number_after[i];
    const float t = -place_before[i] / std::max(span, 1e-3F);
    const float slope = rise / std::max(span, 0.1F);
    const float weight_before = (1 - t) * (1 - t);
    const float weight_after = t * t;
    const float spread = slope * slope * (weight_before * vb + weight_after * va) +
                         search.excess_variance * (weight_before + weight_after);
    const bool coded = code[i] != CodeMap::kNoCode;
    const float middle = static_cast<float>(code[i]) + 0.5F;
    const float number = between ? from + t * rise : middle;
    value[i] = coded ? number * stripe + origin : kNan;
    variance[i] = coded ? (between ? spread : 1.0F / 12.0F) * stripe * stripe : kNan;
  }
}

}  // namespace

RAYSTEER_CLONES void classify(const GraySums<std::uint8_t>& sums, const std::uint8_t* white, const std::uint8_t* black,
                              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance) {
  classify_row(sums, white, black, limits, code, mask, variance);
}

RAYSTEER_CLONES void classify(const GraySums<std::uint16_t>& sums, const std::uint16_t* white,
                              const std::uint16_t* black, const GrayLimits& limits, std::uint16_t* code,
                              std::uint8_t* mask, float* variance) {
  classify_row(sums, white, black, limits, code, mask, variance);
}

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint8_t>& a, const EdgeSource<std::uint8_t>& b, int count,
                                  const GapRow& gaps) {
  find_row_borders(a, b, count, gaps);
}

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint16_t>& a, const EdgeSource<std::uint16_t>& b, int count,
                                  const GapRow& gaps) {
  find_row_borders(a, b, count, gaps);
}

RAYSTEER_CLONES void place_between_borders(const BorderSearch& search, const std::uint16_t* code, int count,
                                           float* value, float* variance, float* scratch) {
  place_row(search, code, count, value, variance, scratch);
}

}  // namespace raysteer::calib::decode
