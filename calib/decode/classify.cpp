#include "calib/decode/classify.hpp"

#include <cmath>

#include "calib/decode/code_map.hpp"
#include "calib/decode/vectorise.hpp"

#ifdef RAYSTEER_AVX2
#include <immintrin.h>
#endif

namespace raysteer::calib::decode {
namespace {

// Written for the vectoriser: masks of one type instead of bool, `&` and `|` instead of `&&` and `||`.
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

}  // namespace raysteer::calib::decode
