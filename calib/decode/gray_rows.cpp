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

template <class T>
[[gnu::always_inline]] inline void find_row_borders(const EdgeSource<T>& a, const EdgeSource<T>& b, int count,
                                                    const GapRow& gaps) {
  const std::uint16_t* __restrict code_a = a.code;
  const std::uint16_t* __restrict code_b = b.code;
  float* __restrict place_a = gaps.place_a;
  float* __restrict place_b = gaps.place_b;
  float* __restrict variance_a = gaps.variance_a;
  float* __restrict variance_b = gaps.variance_b;
  for (int i = 0; i < count; ++i) {
    const int ca = code_a[i];
    const int cb = code_b[i];
    const int change = cb - ca;
    const int rise = change > 0 ? 1 : 0;
    const float sign = change > 0 ? 1.0F : -1.0F;
    const float fine_a = a.finest[i];
    const float fine_b = b.finest[i];
    const float weak_a = a.weakest[i];
    const float weak_b = b.weakest[i];
    const int label_a = a.weakest_bit[i];
    const int label_b = b.weakest_bit[i];
    const float noise = 0.5F * (a.variance[i] + b.variance[i]);
    const bool near = change >= -2 && change <= 2;
    const bool same = change == 0 && ca != CodeMap::kNoCode;
    // The difference falls from fine_a at pixel a to -fine_b at b: linear between, 0 at the border.
    const auto border = [&](int n, float* place, float* variance) {
      const bool odd = (n & 1) != 0;
      const int label = border_label(n);
      const float at_a = odd ? fine_a : weak_a;
      const float at_b = odd ? fine_b : weak_b;
      const float sum = at_a + at_b;
      const bool found = near && sum > 0 && (odd || (label_a == label && label_b == label));
      const float inverse = 1.0F / std::max(sum, 1.0F);
      const float f = at_a * inverse;
      const float spread = noise * (f * f + (1 - f) * (1 - f)) * inverse * inverse;
      place[i] = f;
      variance[i] = same ? GapRow::kSame : found ? sign * spread : GapRow::kLost;
    };
    border(ca + rise, place_a, variance_a);
    border(cb + 1 - rise, place_b, variance_b);
  }
}

/// Takes gap k where nothing was found yet; returns whether some pixel still has nothing.
[[gnu::always_inline]] inline bool search_gap(const float* __restrict place, const float* __restrict variance,
                                              float shift, int count, float* __restrict found_place,
                                              float* __restrict found_variance) {
  int open = 0;
  for (int i = 0; i < count; ++i) {
    const bool take = found_variance[i] == GapRow::kSame;
    const float here = take ? variance[i] : found_variance[i];
    found_place[i] = take ? place[i] + shift : found_place[i];
    found_variance[i] = here;
    open |= here == GapRow::kSame ? 1 : 0;
  }
  return open != 0;
}

[[gnu::always_inline]] inline void place_row(const BorderSearch& search, const std::uint16_t* __restrict code,
                                             int count, float* __restrict value, float* __restrict variance,
                                             float* __restrict scratch) {
  float* __restrict before = scratch;
  float* __restrict before_variance = scratch + count;
  float* __restrict after = scratch + 2 * static_cast<std::ptrdiff_t>(count);
  float* __restrict after_variance = scratch + 3 * static_cast<std::ptrdiff_t>(count);
  std::fill(before_variance, before_variance + count, GapRow::kSame);
  std::fill(after_variance, after_variance + count, GapRow::kSame);
  for (int k = 0; k < search.reach; ++k) {
    const float shift = -1.0F - static_cast<float>(k);
    if (!search_gap(search.place_before[k], search.variance_before[k], shift, count, before, before_variance)) {
      break;
    }
  }
  for (int k = 0; k < search.reach; ++k) {
    const float shift = static_cast<float>(k);
    if (!search_gap(search.place_after[k], search.variance_after[k], shift, count, after, after_variance)) {
      break;
    }
  }
  const float stripe = search.stripe_px;
  const float origin = -search.offset_px - 0.5F;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  for (int i = 0; i < count; ++i) {
    const float vb = before_variance[i];
    const float va = after_variance[i];
    const float span = after[i] - before[i];
    // Signs agree: the code rises, or falls, through the pixel. Otherwise it turns here, or a side is missing.
    const bool between = vb * va > 0 && std::abs(vb) < GapRow::kSame && std::abs(va) < GapRow::kSame && span > 0;
    const float scale = 1.0F / std::max(span, 1e-3F);
    const float t = -before[i] * scale;
    const float inside = between ? (va > 0 ? t : 1 - t) : 0.5F;
    const float spread = ((1 - t) * (1 - t) * std::abs(vb) + t * t * std::abs(va)) * scale * scale;
    const bool coded = code[i] != CodeMap::kNoCode;
    value[i] = coded ? (static_cast<float>(code[i]) + inside) * stripe + origin : kNan;
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
