#include "calib/decode/gray_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/decode/code_map.hpp"
#include "calib/decode/vectorise.hpp"

#ifdef RAYSTEER_AVX2
#include <immintrin.h>
#endif

namespace raysteer::calib::decode {
namespace {

/// Pixels placed together: what is found on both sides of them, 6 floats each, stays in the first-level cache, and a
/// far border of one does not send all of a row searching.
constexpr int kPiece = 256;

// Written for the vectoriser: values instead of references (std::min, std::max), masks of one type instead of bool, `&`
// and `|` instead of `&&` and `||`.
template <class T>
[[gnu::always_inline]] inline T lesser(T a, T b) {
  return a < b ? a : b;
}
template <class T>
[[gnu::always_inline]] inline T greater(T a, T b) {
  return a < b ? b : a;
}

/// The bit that border n (between codes n - 1 and n) changes, as GraySums::weakest_bit labels it.
[[gnu::always_inline]] inline int border_label(int n) { return lesser((n & -n) >> 1, kMostLabel); }

template <class T, bool kReferences, bool kVariance>
[[gnu::always_inline]] inline void classify_row(const GraySums<T>& sums, const T* __restrict white,
                                                const T* __restrict black, const GrayLimits& limits,
                                                std::uint16_t* __restrict code, std::uint8_t* __restrict mask,
                                                float* __restrict variance) {
  const GrayLimits l = limits;
  const int coarse = l.coarse ? 1 : 0;
  const T* __restrict low = sums.code_low;
  const T* __restrict high = sums.code_high;
  const T* __restrict weakest = sums.weakest;
  const T* __restrict weakest_bit = sums.weakest_bit;
  const T* __restrict second = sums.second;
  const T* __restrict direct = sums.direct;
  const T* __restrict unlit = sums.unlit;
  const T* __restrict coarse_unlit = sums.coarse_unlit;
  const T* __restrict coarse_lit = sums.coarse_lit;
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < l.width; ++i) {
    int c = low[i];
    if constexpr (sizeof(T) == 1) {
      c |= high[i] << 8;
    }
    c ^= c >> 1;
    c ^= c >> 2;
    c ^= c >> 4;
    c ^= c >> 8;

    const int d = direct[i];
    const int dark = unlit[i];
    const float variance_here = l.difference_floor + l.difference_slope * static_cast<float>(d + 2 * dark);
    const float least2 = greater(l.min_sigma2 * variance_here, l.min_difference2);
    const auto w1 = static_cast<float>(weakest[i]);
    const auto w2 = static_cast<float>(second[i]);
    const auto direct_here = static_cast<float>(d);

    // The pixel lies on the border whose bit is weak: either code is right. Any other weak bit is a guess.
    const int elsewhere = weakest_bit[i] != border_label((c + 1) & ~1) ? 1 : 0;
    int ambiguous = ((w1 * w1 < least2 ? 1 : 0) & elsewhere) | (w2 * w2 < least2 ? 1 : 0);
    const int weak = direct_here * direct_here < least2 ? 1 : 0;
    int shadow = 0;
    int ambient = 0;
    if constexpr (kReferences) {
      ambient = black[i];
      const auto contrast = static_cast<float>(white[i] - ambient);
      shadow = (contrast * contrast < least2 ? 1 : 0) | (contrast < l.min_contrast ? 1 : 0);
    }
    // Xu and Aliaga: with little global light (d > g) the sign decides; with much, only values that direct or global
    // light alone could not have made. All coarse bits pass when their extremes do.
    const int global = 2 * (dark - ambient);
    const int mixed = (coarse_unlit[i] - ambient > d ? 1 : 0) | (coarse_lit[i] - ambient < global ? 1 : 0);
    ambiguous |= coarse & (d <= global ? 1 : 0) & mixed;
    const int saturated = weak & (static_cast<float>(dark) >= l.saturation ? 1 : 0);
    const int undecided = shadow | weak | ambiguous;
    const int outside = (c >= l.codes ? 1 : 0) & (undecided ^ 1);
    const int reasons =
        shadow * kShadow | weak * kLowModulation | saturated * kSaturated | ambiguous * kAmbiguous | outside * kOutside;
    mask[i] = static_cast<std::uint8_t>(mask[i] | reasons);
    code[i] = static_cast<std::uint16_t>(reasons == 0 ? c : int{CodeMap::kNoCode});
    if constexpr (kVariance) {
      variance[i] = variance_here;
    }
  }
}

template <class T>
[[gnu::always_inline]] inline void classify_any(const GraySums<T>& sums, const T* white, const T* black,
                                                const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask,
                                                float* variance) {
  if (white != nullptr && variance != nullptr) {
    classify_row<T, true, true>(sums, white, black, limits, code, mask, variance);
  } else if (white != nullptr) {
    classify_row<T, true, false>(sums, white, black, limits, code, mask, variance);
  } else if (variance != nullptr) {
    classify_row<T, false, true>(sums, white, black, limits, code, mask, variance);
  } else {
    classify_row<T, false, false>(sums, white, black, limits, code, mask, variance);
  }
}

#ifdef RAYSTEER_AVX2

/// Row of bytes, `i` on, as 16 lanes of 16 bits.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i widen(const std::uint8_t* row, int i) {
  return _mm256_cvtepu8_epi16(_mm_loadu_si128(reinterpret_cast<const __m128i*>(row + i)));
}

/// 8 lanes of the variance of p - q, from d + 2 dark.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256 variance_of(const GrayLimits& l, __m128i light) {
  const __m256 sum = _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(light));
  return _mm256_add_ps(_mm256_set1_ps(l.difference_floor), _mm256_mul_ps(_mm256_set1_ps(l.difference_slope), sum));
}

/// The least whole square that is believed. A square of 8 bits lies below `least2` just if it lies below this.
[[gnu::target("avx2"), gnu::always_inline]] inline __m256i whole_least2(const GrayLimits& l, __m256 variance) {
  const __m256 least2 =
      _mm256_max_ps(_mm256_mul_ps(_mm256_set1_ps(l.min_sigma2), variance), _mm256_set1_ps(l.min_difference2));
  return _mm256_cvttps_epi32(_mm256_ceil_ps(_mm256_min_ps(least2, _mm256_set1_ps(65535))));
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256i below(__m256i a, __m256i b) {
  // 16 bits without sign: the difference that saturates at 0 is not 0.
  return _mm256_xor_si256(_mm256_cmpeq_epi16(_mm256_subs_epu16(b, a), _mm256_setzero_si256()), _mm256_set1_epi16(-1));
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256i too_small(__m256i least2, __m256i value) {
  return below(_mm256_mullo_epi16(value, value), least2);
}

[[gnu::target("avx2"), gnu::always_inline]] inline __m256i reason(__m256i holds, Reason which) {
  return _mm256_and_si256(holds, _mm256_set1_epi16(which));
}

/// A whole number that values of 8 bits, or their differences, are compared with.
inline short whole(float limit) { return static_cast<short>(std::ceil(greater(-1000.0F, lesser(limit, 1000.0F)))); }

/// classify_row() with the masks of 16 pixels a register; only variances need 32 bits. Returns how many pixels it did.
[[gnu::target("avx2")]] int classify_registers(const GraySums<std::uint8_t>& sums, const std::uint8_t* white,
                                               const std::uint8_t* black, const GrayLimits& limits, std::uint16_t* code,
                                               std::uint8_t* mask, float* variance) {
  const GrayLimits l = limits;
  const __m256i ones = _mm256_set1_epi16(-1);
  const __m256i none = _mm256_setzero_si256();
  const __m256i one = _mm256_set1_epi16(1);
  const __m256i coarse = l.coarse ? ones : none;
  const __m256i min_contrast = _mm256_set1_epi16(whole(l.min_contrast));
  const __m256i saturation = _mm256_set1_epi16(whole(l.saturation));
  const __m256i last_code = _mm256_set1_epi16(static_cast<short>(lesser(l.codes, 65536) - 1));
  int i = 0;
  for (; i + 16 <= l.width; i += 16) {
    __m256i c = _mm256_or_si256(widen(sums.code_low, i), _mm256_slli_epi16(widen(sums.code_high, i), 8));
    c = _mm256_xor_si256(c, _mm256_srli_epi16(c, 1));
    c = _mm256_xor_si256(c, _mm256_srli_epi16(c, 2));
    c = _mm256_xor_si256(c, _mm256_srli_epi16(c, 4));
    c = _mm256_xor_si256(c, _mm256_srli_epi16(c, 8));

    const __m256i d = widen(sums.direct, i);
    const __m256i dark = widen(sums.unlit, i);
    const __m256i light = _mm256_add_epi16(d, _mm256_slli_epi16(dark, 1));
    const __m256 variance_low = variance_of(l, _mm256_castsi256_si128(light));
    const __m256 variance_high = variance_of(l, _mm256_extracti128_si256(light, 1));
    if (variance != nullptr) {
      _mm256_storeu_ps(variance + i, variance_low);
      _mm256_storeu_ps(variance + i + 8, variance_high);
    }
    const __m256i least2 = _mm256_permute4x64_epi64(
        _mm256_packus_epi32(whole_least2(l, variance_low), whole_least2(l, variance_high)), 0xd8);

    const __m256i n = _mm256_andnot_si256(one, _mm256_add_epi16(c, one));
    const __m256i label = _mm256_min_epu16(_mm256_srli_epi16(_mm256_and_si256(n, _mm256_sub_epi16(none, n)), 1),
                                           _mm256_set1_epi16(kMostLabel));
    const __m256i here = _mm256_cmpeq_epi16(widen(sums.weakest_bit, i), label);
    __m256i ambiguous = _mm256_or_si256(_mm256_andnot_si256(here, too_small(least2, widen(sums.weakest, i))),
                                        too_small(least2, widen(sums.second, i)));
    const __m256i weak = too_small(least2, d);
    __m256i shadow = none;
    __m256i ambient = none;
    if (white != nullptr) {
      ambient = widen(black, i);
      const __m256i contrast = _mm256_sub_epi16(widen(white, i), ambient);
      shadow = _mm256_or_si256(too_small(least2, contrast), _mm256_cmpgt_epi16(min_contrast, contrast));
    }
    const __m256i global = _mm256_slli_epi16(_mm256_sub_epi16(dark, ambient), 1);
    const __m256i mixed =
        _mm256_or_si256(_mm256_cmpgt_epi16(_mm256_sub_epi16(widen(sums.coarse_unlit, i), ambient), d),
                        _mm256_cmpgt_epi16(global, _mm256_sub_epi16(widen(sums.coarse_lit, i), ambient)));
    const __m256i scattered = _mm256_andnot_si256(_mm256_cmpgt_epi16(d, global), coarse);
    ambiguous = _mm256_or_si256(ambiguous, _mm256_and_si256(scattered, mixed));
    const __m256i saturated = _mm256_andnot_si256(_mm256_cmpgt_epi16(saturation, dark), weak);
    const __m256i undecided = _mm256_or_si256(_mm256_or_si256(shadow, weak), ambiguous);
    const __m256i outside = _mm256_andnot_si256(undecided, below(last_code, c));

    const __m256i reasons =
        _mm256_or_si256(_mm256_or_si256(_mm256_or_si256(reason(shadow, kShadow), reason(weak, kLowModulation)),
                                        _mm256_or_si256(reason(saturated, kSaturated), reason(ambiguous, kAmbiguous))),
                        reason(outside, kOutside));
    const __m256i coded = _mm256_cmpeq_epi16(reasons, none);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(code + i), _mm256_or_si256(c, _mm256_xor_si256(coded, ones)));
    __m128i* at = reinterpret_cast<__m128i*>(mask + i);
    const __m128i packed = _mm_packus_epi16(_mm256_castsi256_si128(reasons), _mm256_extracti128_si256(reasons, 1));
    _mm_storeu_si128(at, _mm_or_si128(_mm_loadu_si128(at), packed));
  }
  return i;
}

#endif

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
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const int ca = code_a[i];
    const int cb = code_b[i];
    const int ha = ca >> 1;
    const int hb = cb >> 1;
    const int step = hb - ha;
    // A code of kNoCode is so large that its step is, too; two of them lie at the end of the range.
    const int lost = (step > 1 ? 1 : 0) | (step < -1 ? 1 : 0) | (ca == CodeMap::kNoCode ? 1 : 0);
    const float noise = 0.5F * (noise_a[i] + noise_b[i]);

    // Even border: some bit but the last; its difference is the weakest at both pixels.
    const int even = 2 * greater(ha, hb);
    const int even_a = weakest_a[i];
    const int even_sum = even_a + weakest_b[i];
    const int even_label = border_label(even);
    const int has_even = (step != 0 ? 1 : 0) & (label_a[i] == even_label ? 1 : 0) & (label_b[i] == even_label ? 1 : 0) &
                         (even_sum > 0 ? 1 : 0);
    // Odd border: the last bit. Where h steps too, the codes' parity says on which side of the even border it lies.
    const int has_odd = (ca ^ ha ^ cb ^ hb) & 1;
    const int at_b = (step > 0 ? 1 : 0) & ca & 1;
    const int at_b_falling = (step < 0 ? 1 : 0) & (ca ^ 1) & 1;
    const int odd = 2 * (ha + (at_b | at_b_falling) * step) + 1;
    const int odd_a = finest_a[i];
    const int odd_sum = odd_a + finest_b[i];

    // The difference falls from its value at a to its negative at b: linear between, 0 at the border.
    const float even_scale = 1.0F / static_cast<float>(greater(even_sum, 1));
    const float odd_scale = 1.0F / static_cast<float>(greater(odd_sum, 1));
    const float fe = static_cast<float>(even_a) * even_scale;
    const float fo = static_cast<float>(odd_a) * odd_scale;
    const int even_before = fe <= fo ? 1 : 0;
    const int a_even = has_even & ((has_odd ^ 1) | even_before);
    const int b_even = has_even & ((has_odd ^ 1) | (even_before ^ 1));
    // Sums with weights 0 or 1 where a choice would be a branch.
    const auto of_a = static_cast<float>(a_even);
    const auto of_b = static_cast<float>(b_even);
    const float fa = fo + of_a * (fe - fo);
    const float fb = fo + of_b * (fe - fo);
    const float scale_a = odd_scale + of_a * (even_scale - odd_scale);
    const float scale_b = odd_scale + of_b * (even_scale - odd_scale);
    const float none = static_cast<float>((has_even | has_odd) ^ 1) * GapRow::kNone;
    const auto known = static_cast<float>(lost ^ 1);
    out_place_a[i] = fa;
    out_place_b[i] = fb;
    out_number_a[i] = static_cast<float>(odd + a_even * (even - odd));
    out_number_b[i] = static_cast<float>(odd + b_even * (even - odd));
    out_variance_a[i] = known * (noise * scale_a * scale_a * (fa * fa + (1 - fa) * (1 - fa)) + none);
    out_variance_b[i] = known * (noise * scale_b * scale_b * (fb * fb + (1 - fb) * (1 - fb)) + none);
  }
}

/// No pixel of a piece has a code: shadow, mostly, of which there is much and in large pieces.
[[gnu::always_inline]] inline bool nothing_coded(const std::uint16_t* __restrict code, int count) {
  std::uint16_t all = CodeMap::kNoCode;
  for (int i = 0; i < count; ++i) {
    all = static_cast<std::uint16_t>(all & code[i]);
  }
  return all == CodeMap::kNoCode;
}

/// The same by pieces, of which those in shadow have lost gaps only; place and number of such are never used.
template <class T>
[[gnu::always_inline]] inline void find_by_pieces(const EdgeSource<T>& a, const EdgeSource<T>& b, int count,
                                                  const GapRow& gaps) {
  for (int first = 0; first < count; first += kPiece) {
    const int size = lesser(kPiece, count - first);
    const GapRow here{gaps.place_a + first,  gaps.place_b + first,    gaps.number_a + first,
                      gaps.number_b + first, gaps.variance_a + first, gaps.variance_b + first};
    if (nothing_coded(a.code + first, size)) {
      for (int i = 0; i < size; ++i) {
        here.variance_a[i] = GapRow::kLost;
        here.variance_b[i] = GapRow::kLost;
      }
      continue;
    }
    const auto from = [first](const EdgeSource<T>& row) {
      return EdgeSource<T>{row.code + first, row.finest + first, row.weakest + first, row.weakest_bit + first,
                           row.variance + first};
    };
    find_row_borders(from(a), from(b), size, here);
  }
}

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

void classify(const GraySums<std::uint8_t>& sums, const std::uint8_t* white, const std::uint8_t* black,
              const GrayLimits& limits, std::uint16_t* code, std::uint8_t* mask, float* variance) {
  int done = 0;
#ifdef RAYSTEER_AVX2
  if (__builtin_cpu_supports("avx2")) {
    done = classify_registers(sums, white, black, limits, code, mask, variance);
  }
#endif
  const auto from = [done](auto* row) { return row != nullptr ? row + done : nullptr; };
  const GraySums<std::uint8_t> rest{
      from(sums.code_low), from(sums.code_high), from(sums.finest), from(sums.weakest),      from(sums.weakest_bit),
      from(sums.second),   from(sums.direct),    from(sums.unlit),  from(sums.coarse_unlit), from(sums.coarse_lit)};
  GrayLimits rest_limits = limits;
  rest_limits.width = limits.width - done;
  classify_any(rest, from(white), from(black), rest_limits, code + done, mask + done, from(variance));
}

RAYSTEER_CLONES void classify(const GraySums<std::uint16_t>& sums, const std::uint16_t* white,
                              const std::uint16_t* black, const GrayLimits& limits, std::uint16_t* code,
                              std::uint8_t* mask, float* variance) {
  classify_any(sums, white, black, limits, code, mask, variance);
}

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint8_t>& a, const EdgeSource<std::uint8_t>& b, int count,
                                  const GapRow& gaps) {
  find_by_pieces(a, b, count, gaps);
}

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint16_t>& a, const EdgeSource<std::uint16_t>& b, int count,
                                  const GapRow& gaps) {
  find_by_pieces(a, b, count, gaps);
}

RAYSTEER_CLONES void place_between_borders(const BorderSearch& search, const std::uint16_t* code, int count,
                                           float* value, float* variance) {
  for (int first = 0; first < count; first += kPiece) {
    place_piece(search, first, code + first, lesser(kPiece, count - first), value + first, variance + first);
  }
}

}  // namespace raysteer::calib::decode
