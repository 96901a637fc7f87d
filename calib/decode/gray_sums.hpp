// value: what is kept of the Gray patterns of one axis, per camera pixel, whatever their number.
//
// A pattern p and its inverse q give a bit (p > q) and a difference |p - q|. The coordinate is measured at the borders
// of stripes, and each border changes one bit only: bit 0 at every second border, some other bit at those between.
// So two differences per pixel are enough to place both of its borders: that of bit 0, and the least among the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>

namespace raysteer::calib::decode {

/// One row of sums. T is the type of the frames' pixels.
template <class T>
struct GraySums {
  T* code_low;      ///< Gray code, bits 0..7 (8-bit frames) or all
  T* code_high;     ///< Gray code, bits 8..15 (8-bit frames)
  T* finest;        ///< |p - q| of bit 0
  T* weakest;       ///< least |p - q| of the other bits
  T* weakest_bit;   ///< whose it is: label(bit)
  T* second;        ///< second least |p - q| of the other bits
  T* direct;        ///< |p - q| of a bit with narrow but resolved stripes: what comes straight from the projector
  T* unlit;         ///< min(p, q) of that bit: ambient and half of the global light
  T* coarse_unlit;  ///< largest min(p, q) of the bits with wide stripes
  T* coarse_lit;    ///< least max(p, q) of those
};

/// Bits in a byte: bit 1 is 1, bit 2 is 2, bit 3 is 4, ...; bits from 8 on share 128. They are so far apart on the
/// panel that taking one for the other is found out by the code.
constexpr int kMostLabel = 128;
constexpr int label(int bit) { return bit >= 8 ? kMostLabel : (1 << bit) >> 1; }
/// Of the bit that border n, between codes n - 1 and n, changes.
constexpr int border_label(int n) {
  const int lowest = (n & -n) >> 1;
  return lowest < kMostLabel ? lowest : kMostLabel;
}

/// Which of the sums a bit goes into.
struct BitRole {
  int bit = 0;
  bool direct = false;
  bool coarse = false;
};

/// Folds `count` pixels of pattern and inverse into a row of sums.
void fold(const BitRole& role, const std::uint8_t* p, const std::uint8_t* q, int count,
          const GraySums<std::uint8_t>& sums);
void fold(const BitRole& role, const std::uint16_t* p, const std::uint16_t* q, int count,
          const GraySums<std::uint16_t>& sums);

/// Rows of sums.
template <class T>
class GrayStore {
 public:
  GrayStore() = default;
  GrayStore(int width, int rows)
      : width_(width),
        plane_(static_cast<std::size_t>(width) * static_cast<std::size_t>(rows)),
        memory_(std::make_unique_for_overwrite<T[]>(kPlanes * plane_)) {}
  GraySums<T> row(int y) const {
    T* first = memory_.get() + static_cast<std::ptrdiff_t>(y) * width_;
    const auto plane = [&](std::size_t index) { return first + index * plane_; };
    return {plane(0), plane(1), plane(2), plane(3), plane(4), plane(5), plane(6), plane(7), plane(8), plane(9)};
  }
  void clear_rows(int first, int last);

 private:
  static constexpr std::size_t kPlanes = 10;
  int width_ = 0;
  std::size_t plane_ = 0;
  std::unique_ptr<T[]> memory_;
};

}  // namespace raysteer::calib::decode
