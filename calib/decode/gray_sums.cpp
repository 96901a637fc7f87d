#include "calib/decode/gray_sums.hpp"

#include <algorithm>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// One pass over the row for all sums that a bit goes into. What it is for is known at compile time.
template <class T, bool kFinest, bool kDirect, bool kCoarse>
[[gnu::always_inline]] inline void fold_row(int bit, const T* __restrict p, const T* __restrict q, int count,
                                            const GraySums<T>& sums) {
  constexpr int kBits = std::numeric_limits<T>::digits;
  const auto code_bit = static_cast<T>(1U << static_cast<unsigned>(bit % kBits));
  const auto here = static_cast<T>(label(bit));
  T* __restrict code = bit < kBits ? sums.code_low : sums.code_high;
  T* __restrict finest = sums.finest;
  T* __restrict weakest = sums.weakest;
  T* __restrict weakest_bit = sums.weakest_bit;
  T* __restrict second = sums.second;
  T* __restrict direct = sums.direct;
  T* __restrict unlit = sums.unlit;
  T* __restrict coarse_unlit = sums.coarse_unlit;
  T* __restrict coarse_lit = sums.coarse_lit;
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const T low = lesser(p[i], q[i]);
    const T high = greater(p[i], q[i]);
    const T difference = static_cast<T>(high - low);
    code[i] = static_cast<T>(code[i] | (p[i] > q[i] ? code_bit : T{0}));
    if constexpr (kFinest) {
      finest[i] = difference;
    } else {
      const T before = weakest[i];
      second[i] = lesser(second[i], greater(before, difference));
      weakest_bit[i] = difference < before ? here : weakest_bit[i];
      weakest[i] = lesser(before, difference);
    }
    if constexpr (kDirect) {
      const T most = direct[i];
      unlit[i] = difference < most ? unlit[i] : low;
      direct[i] = greater(most, difference);
    }
    if constexpr (kCoarse) {
      coarse_unlit[i] = greater(coarse_unlit[i], low);
      coarse_lit[i] = lesser(coarse_lit[i], high);
    }
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_all(const BitRole& role, const T* p, const T* q, int count,
                                            const GraySums<T>& sums) {
  if (role.bit == 0) {
    if (role.direct) {
      fold_row<T, true, true, false>(role.bit, p, q, count, sums);
    } else {
      fold_row<T, true, false, false>(role.bit, p, q, count, sums);
    }
  } else if (role.direct) {
    fold_row<T, false, true, false>(role.bit, p, q, count, sums);
  } else if (role.coarse) {
    fold_row<T, false, false, true>(role.bit, p, q, count, sums);
  } else {
    fold_row<T, false, false, false>(role.bit, p, q, count, sums);
  }
}

}  // namespace

RAYSTEER_CLONES void fold(const BitRole& role, const std::uint8_t* p, const std::uint8_t* q, int count,
                          const GraySums<std::uint8_t>& sums) {
  fold_all(role, p, q, count, sums);
}

RAYSTEER_CLONES void fold(const BitRole& role, const std::uint16_t* p, const std::uint16_t* q, int count,
                          const GraySums<std::uint16_t>& sums) {
  fold_all(role, p, q, count, sums);
}

template <class T>
void GrayStore<T>::clear_rows(int first, int last) {
  constexpr T kMost = std::numeric_limits<T>::max();
  // In the order of GraySums: codes and maxima start at 0, minima at the most there is.
  constexpr T kStart[kPlanes] = {0, 0, 0, kMost, 0, kMost, 0, 0, 0, kMost};
  const std::size_t begin = static_cast<std::size_t>(first) * static_cast<std::size_t>(width_);
  const std::size_t end = static_cast<std::size_t>(last) * static_cast<std::size_t>(width_);
  for (std::size_t plane = 0; plane < kPlanes; ++plane) {
    T* start = memory_.get() + plane * plane_;
    std::fill(start + begin, start + end, kStart[plane]);
  }
}

template class GrayStore<std::uint8_t>;
template class GrayStore<std::uint16_t>;

}  // namespace raysteer::calib::decode
