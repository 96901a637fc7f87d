#include "calib/decode/gray_sums.hpp"

#include <algorithm>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

template <class T>
[[gnu::always_inline]] inline void fold_code(int bit, const T* __restrict p, const T* __restrict q, int count,
                                             const GraySums<T>& sums) {
  constexpr int kBits = std::numeric_limits<T>::digits;
  T* __restrict code = bit < kBits ? sums.code_low : sums.code_high;
  const T value = static_cast<T>(1U << static_cast<unsigned>(bit % kBits));
  for (int i = 0; i < count; ++i) {
    code[i] = static_cast<T>(code[i] | (p[i] > q[i] ? value : T{0}));
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_finest(const T* __restrict p, const T* __restrict q, int count,
                                               const GraySums<T>& sums) {
  T* __restrict finest = sums.finest;
  for (int i = 0; i < count; ++i) {
    finest[i] = static_cast<T>(std::max(p[i], q[i]) - std::min(p[i], q[i]));
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_weakest(int bit, const T* __restrict p, const T* __restrict q, int count,
                                                const GraySums<T>& sums) {
  T* __restrict weakest = sums.weakest;
  T* __restrict weakest_bit = sums.weakest_bit;
  T* __restrict second = sums.second;
  const T here = static_cast<T>(label(bit));
  for (int i = 0; i < count; ++i) {
    const T difference = static_cast<T>(std::max(p[i], q[i]) - std::min(p[i], q[i]));
    const T before = weakest[i];
    second[i] = std::min(second[i], std::max(before, difference));
    weakest_bit[i] = difference < before ? here : weakest_bit[i];
    weakest[i] = std::min(before, difference);
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_direct(const T* __restrict p, const T* __restrict q, int count,
                                               const GraySums<T>& sums) {
  T* __restrict direct = sums.direct;
  T* __restrict unlit = sums.unlit;
  for (int i = 0; i < count; ++i) {
    const T low = std::min(p[i], q[i]);
    const T difference = static_cast<T>(std::max(p[i], q[i]) - low);
    unlit[i] = difference > direct[i] ? low : unlit[i];
    direct[i] = std::max(direct[i], difference);
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_coarse(const T* __restrict p, const T* __restrict q, int count,
                                               const GraySums<T>& sums) {
  T* __restrict unlit = sums.coarse_unlit;
  T* __restrict lit = sums.coarse_lit;
  for (int i = 0; i < count; ++i) {
    unlit[i] = std::max(unlit[i], std::min(p[i], q[i]));
    lit[i] = std::min(lit[i], std::max(p[i], q[i]));
  }
}

template <class T>
[[gnu::always_inline]] inline void fold_all(const BitRole& role, const T* p, const T* q, int count,
                                            const GraySums<T>& sums) {
  fold_code(role.bit, p, q, count, sums);
  if (role.bit == 0) {
    fold_finest(p, q, count, sums);
  } else {
    fold_weakest(role.bit, p, q, count, sums);
  }
  if (role.direct) {
    fold_direct(p, q, count, sums);
  }
  if (role.coarse) {
    fold_coarse(p, q, count, sums);
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
