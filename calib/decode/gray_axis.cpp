#include "calib/decode/gray_axis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calib/decode/place_pixels.hpp"

namespace raysteer::calib::decode {
namespace {

/// How far a border may be: four times the stripe's width in camera pixels if the camera saw just the panel.
int reach_of(int camera_px, int codes) { return std::clamp(4 * camera_px / std::max(codes, 1), 6, 64); }

/// Floats of a gap: place, number, variance, twice.
constexpr int kParts = 6;

}  // namespace

template <class T>
GrayAxis<T>::GrayAxis(Axis axis, const PatternBlock& block, const GrayLimits& limits, BorderTable borders, int height,
                      Image<std::uint16_t>& code, Image<float>* value, Image<float>* variance)
    : axis_(axis),
      block_(block),
      limits_(limits),
      borders_(std::move(borders)),
      height_(height),
      code_(&code),
      value_(value),
      variance_(variance) {
  if (value_ == nullptr) {
    return;
  }
  const int width = limits_.width;
  reach_ = reach_of(axis_ == Axis::kX ? width : height_, limits_.codes);
  // x: one row of gaps with `reach` lost ones at either end. y: a ring of rows, and a row of lost gaps behind it.
  stride_ = axis_ == Axis::kX ? width + 2 * reach_ + 1 : width;
  gap_rows_ = axis_ == Axis::kX ? 1 : 2 * reach_ + 1;
  static_assert(GapRow::kLost == 0, "rows of gaps are lost ones at first");
  gaps_.assign(kParts * static_cast<std::size_t>(stride_) * static_cast<std::size_t>(gap_rows_ + 1), 0.0F);
  noise_.resize(2 * static_cast<std::size_t>(width));
  previous_.resize(3 * static_cast<std::size_t>(width));
  before_.resize(static_cast<std::size_t>(reach_));
  after_.resize(static_cast<std::size_t>(reach_));
}

template <class T>
GapRow GrayAxis<T>::gap(int index, int first) {
  float* row = gaps_.data() + static_cast<std::ptrdiff_t>(kParts) * index * stride_ + first;
  const auto part = [&](int k) { return row + static_cast<std::ptrdiff_t>(k) * stride_; };
  return {part(0), part(3), part(1), part(4), part(2), part(5)};
}

template <class T>
void GrayAxis<T>::row(const GraySums<T>& sums, const T* white, const T* black, std::uint8_t* mask) {
  const bool placed = value_ != nullptr;
  float* noise = placed ? noise_.data() + (next_ % 2) * limits_.width : nullptr;
  classify(sums, white, black, limits_, code_->row(next_), mask, noise);
  if (placed && axis_ == Axis::kX) {
    place_x(sums);
  } else if (placed) {
    place_y(sums);
  }
  ++next_;
}

template <class T>
void GrayAxis<T>::finish() {
  if (axis_ == Axis::kY && value_ != nullptr) {
    for (int v = std::max(0, height_ - reach_); v < height_; ++v) {
      give_out_y(v);
    }
  }
}

template <class T>
void GrayAxis<T>::place_x(const GraySums<T>& sums) {
  const int width = limits_.width;
  const std::uint16_t* code = code_->row(next_);
  const float* noise = noise_.data() + (next_ % 2) * width;
  const EdgeSource<T> a{code, sums.finest, sums.weakest, sums.weakest_bit, noise};
  const EdgeSource<T> b{code + 1, sums.finest + 1, sums.weakest + 1, sums.weakest_bit + 1, noise + 1};
  find_borders(a, b, width - 1, gap(0, reach_));
  // Gap u lies between pixels u and u + 1.
  for (int k = 0; k < reach_; ++k) {
    before_[k] = gap(0, reach_ - 1 - k);
    after_[k] = gap(0, reach_ + k);
  }
  place(next_);
}

template <class T>
void GrayAxis<T>::place_y(const GraySums<T>& sums) {
  const int width = limits_.width;
  const T* before = previous_.data();
  if (next_ > 0) {
    const EdgeSource<T> a{code_->row(next_ - 1), before, before + width,
                          before + 2 * static_cast<std::ptrdiff_t>(width), noise_.data() + ((next_ + 1) % 2) * width};
    const EdgeSource<T> b{code_->row(next_), sums.finest, sums.weakest, sums.weakest_bit,
                          noise_.data() + (next_ % 2) * width};
    find_borders(a, b, width, gap((next_ - 1) % gap_rows_));
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
    before_[k] = gap(index(v - 1 - k));
    after_[k] = gap(index(v + k));
  }
  place(v);
}

template <class T>
void GrayAxis<T>::place(int v) {
  place_between_borders({before_.data(), after_.data(), reach_, static_cast<float>(block_.stripe_px),
                         static_cast<float>(block_.offset_px), borders_.place.empty() ? nullptr : borders_.place.data(),
                         static_cast<int>(borders_.place.size()), borders_.excess_variance},
                        code_->row(v), limits_.width, value_->row(v), variance_->row(v));
}

template class GrayAxis<std::uint8_t>;
template class GrayAxis<std::uint16_t>;

}  // namespace raysteer::calib::decode
