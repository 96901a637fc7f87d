#include "calib/decode/find_borders.hpp"

#include "calib/decode/code_map.hpp"
#include "calib/decode/gray_sums.hpp"
#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// Pixels that are looked at together: in shadow, of which there is much and in large pieces, there are no borders.
constexpr int kPiece = 256;

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

}  // namespace

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint8_t>& a, const EdgeSource<std::uint8_t>& b, int count,
                                  const GapRow& gaps) {
  find_by_pieces(a, b, count, gaps);
}

RAYSTEER_CLONES void find_borders(const EdgeSource<std::uint16_t>& a, const EdgeSource<std::uint16_t>& b, int count,
                                  const GapRow& gaps) {
  find_by_pieces(a, b, count, gaps);
}

}  // namespace raysteer::calib::decode
