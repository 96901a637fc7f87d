// value: pixels. ImageView looks at somebody's pixels, Image owns its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>

namespace raysteer {

/// Rows of pixels that somebody else owns. `stride` is counted in pixels.
template <class T>
class ImageView {
 public:
  constexpr ImageView() = default;
  constexpr ImageView(T* data, int width, int height, std::ptrdiff_t stride)
      : data_(data), width_(width), height_(height), stride_(stride) {}
  constexpr ImageView(T* data, int width, int height) : ImageView(data, width, height, width) {}
  /// A view of changeable pixels is a view of constant ones.
  constexpr operator ImageView<const T>() const requires(!std::is_const_v<T>) {
    return {data_, width_, height_, stride_};
  }

  constexpr int width() const { return width_; }
  constexpr int height() const { return height_; }
  constexpr std::ptrdiff_t stride() const { return stride_; }
  constexpr bool empty() const { return width_ == 0 || height_ == 0; }
  constexpr T* data() const { return data_; }
  constexpr T* row(int y) const { return data_ + y * stride_; }
  constexpr std::span<T> row_span(int y) const { return {row(y), static_cast<std::size_t>(width_)}; }
  constexpr T& operator()(int x, int y) const { return row(y)[x]; }
  constexpr bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

 private:
  T* data_ = nullptr;
  int width_ = 0;
  int height_ = 0;
  std::ptrdiff_t stride_ = 0;
};

/// Pixels without gaps between rows, zero at first. Moves cheaply; copies only through clone().
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height)
      : pixels_(std::make_unique<T[]>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height))),
        width_(width),
        height_(height) {}
  /// Pixels whose values are not set: for code that writes each one.
  static Image uninitialised(int width, int height) {
    Image image;
    image.pixels_ =
        std::make_unique_for_overwrite<T[]>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    image.width_ = width;
    image.height_ = height;
    return image;
  }
  Image(Image&& other) noexcept { swap(other); }
  Image& operator=(Image&& other) noexcept {
    Image moved(std::move(other));
    swap(moved);
    return *this;
  }
  Image clone() const {
    Image copy = uninitialised(width_, height_);
    std::copy(pixels_.get(), pixels_.get() + size(), copy.pixels_.get());
    return copy;
  }

  int width() const { return width_; }
  int height() const { return height_; }
  std::size_t size() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_); }
  bool empty() const { return size() == 0; }
  T* data() { return pixels_.get(); }
  const T* data() const { return pixels_.get(); }
  T* row(int y) { return pixels_.get() + static_cast<std::ptrdiff_t>(y) * width_; }
  const T* row(int y) const { return pixels_.get() + static_cast<std::ptrdiff_t>(y) * width_; }
  T& operator()(int x, int y) { return row(y)[x]; }
  const T& operator()(int x, int y) const { return row(y)[x]; }
  ImageView<T> view() { return {pixels_.get(), width_, height_}; }
  ImageView<const T> view() const { return {pixels_.get(), width_, height_}; }
  void fill(const T& value) { std::fill(pixels_.get(), pixels_.get() + size(), value); }

 private:
  void swap(Image& other) noexcept {
    std::swap(pixels_, other.pixels_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
  }

  std::unique_ptr<T[]> pixels_;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace raysteer
