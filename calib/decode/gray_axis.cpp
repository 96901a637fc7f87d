#include "calib/decode/gray_axis.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::calib::decode {
namespace {

/// How far a border may be: four times the stripe's width in camera pixels if the camera saw just the panel.
int reach_of(int camera_px, int codes) { return std::clamp(4 * camera_px / std::max(codes, 1), 6, 64); }

}  // namespace

template <class T>
GrayAxis<T>::GrayAxis(Axis axis, const PatternBlock& block, const GrayLimits& limits, int height,
                      Image<std::uint16_t>& code, Image<float>& value, Image<float>& variance)
    : axis_(axis), block_(block), limits_(limits), height_(height), code_(code), value_(value), variance_(variance) {
  if (value_.empty()) {
    return;
  }
  const int width = limits_.width;
  reach_ = reach_of(axis_ == Axis::kX ? width : height_, limits_.codes);
  // x: one row of gaps with `reach` lost ones at either end. y: a ring of rows, and a row of lost gaps at its end.
  stride_ = axis_ == Axis::kX ? width + 2 * reach_ + 1 : width;
  gap_rows_ = axis_ == Axis::kX ? 1 : 2 * reach_ + 1;
  const auto size = static_cast<std::size_t>(stride_) * static_cast<std::size_t>(gap_rows_ + 1);
  for (std::vector<float>* store : {&place_a_, &place_b_, &variance_a_, &variance_b_}) {
    store->assign(size, 0.0F);
  }
  noise_.resize(2 * static_cast<std::size_t>(width));
  previous_.resize(3 * static_cast<std::size_t>(width));
  scratch_.resize(4 * static_cast<std::size_t>(width));
  pointers_.resize(4 * static_cast<std::size_t>(reach_));
}

template <class T>
void GrayAxis<T>::row(const GraySums<T>& sums, const T* white, const T* black, std::uint8_t* mask) {
  const bool place = !value_.empty();
  float* noise = place ? noise_.data() + (next_ % 2) * limits_.width : nullptr;
  classify(sums, white, black, limits_, code_.row(next_), mask, noise);
  if (place && axis_ == Axis::kX) {
    place_x(sums);
  } else if (place) {
    place_y(sums);
  }
  ++next_;
}

template <class T>
void GrayAxis<T>::finish() {
  if (axis_ == Axis::kY && !value_.empty()) {
    for (int v = std::max(0, height_ - reach_); v < height_; ++v) {
      give_out_y(v);
    }
  }
}

template <class T>
void GrayAxis<T>::place_x(const GraySums<T>& sums) {
  const int width = limits_.width;
  const std::uint16_t* code = code_.row(next_);
  const float* noise = noise_.data() + (next_ % 2) * width;
  const EdgeSource<T> a{code, sums.finest, sums.weakest, sums.weakest_bit, noise};
  const EdgeSource<T> b{code + 1, sums.finest + 1, sums.weakest + 1, sums.weakest_bit + 1, noise + 1};
  find_borders(
      a, b, width - 1,
      {place_a_.data() + reach_, place_b_.data() + reach_, variance_a_.data() + reach_, variance_b_.data() + reach_});
  // Gap u lies between pixels u and u + 1.
  for (int k = 0; k < reach_; ++k) {
    pointers_[k] = place_b_.data() + reach_ - 1 - k;
    pointers_[reach_ + k] = variance_b_.data() + reach_ - 1 - k;
    pointers_[2 * reach_ + k] = place_a_.data() + reach_ + k;
    pointers_[3 * reach_ + k] = variance_a_.data() + reach_ + k;
  }
  const float* const* first = pointers_.data();
  place_between_borders({first, first + reach_, first + 2 * reach_, first + 3 * reach_, reach_,
                         static_cast<float>(block_.stripe_px), static_cast<float>(block_.offset_px)},
                        code, width, value_.row(next_), variance_.row(next_), scratch_.data());
}

template <class T>
void GrayAxis<T>::place_y(const GraySums<T>& sums) {
  const int width = limits_.width;
  const float* noise = noise_.data() + (next_ % 2) * width;
  const float* noise_before = noise_.data() + ((next_ + 1) % 2) * width;
  if (next_ > 0) {
    const EdgeSource<T> a{code_.row(next_ - 1), previous_.data(), previous_.data() + width,
                          previous_.data() + 2 * static_cast<std::ptrdiff_t>(width), noise_before};
    const EdgeSource<T> b{code_.row(next_), sums.finest, sums.weakest, sums.weakest_bit, noise};
    const int index = (next_ - 1) % gap_rows_;
    find_borders(a, b, width,
                 {gap(place_a_, index), gap(place_b_, index), gap(variance_a_, index), gap(variance_b_, index)});
  }
  std::copy(sums.finest, sums.finest + width, previous_.begin());
  std::copy(sums.weakest, sums.weakest + width, previous_.begin() + width);
  std::copy(sums.weakest_bit, sums.weakest_bit + width, previous_.begin() + 2 * static_cast<std::ptrdiff_t>(width));
  if (next_ >= reach_) {
    give_out_y(next_ - reach_);
  }
}

template <class T>
void GrayAxis<T>::give_out_y(int v) {
  // Gap row v lies between rows v and v + 1; those outside the image are the row of lost gaps behind the ring.
  const auto index = [&](int row) { return row < 0 || row >= height_ - 1 ? gap_rows_ : row % gap_rows_; };
  for (int k = 0; k < reach_; ++k) {
    const int before = index(v - 1 - k);
    const int after = index(v + k);
    pointers_[k] = gap(place_b_, before);
    pointers_[reach_ + k] = gap(variance_b_, before);
    pointers_[2 * reach_ + k] = gap(place_a_, after);
    pointers_[3 * reach_ + k] = gap(variance_a_, after);
  }
  const float* const* first = pointers_.data();
  place_between_borders({first, first + reach_, first + 2 * reach_, first + 3 * reach_, reach_,
                         static_cast<float>(block_.stripe_px), static_cast<float>(block_.offset_px)},
                        code_.row(v), limits_.width, value_.row(v), variance_.row(v), scratch_.data());
}

template class GrayAxis<std::uint8_t>;
template class GrayAxis<std::uint16_t>;

}  // namespace raysteer::calib::decode
