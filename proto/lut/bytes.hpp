// value: numbers as little-endian bytes, there and back. A reader that has run out gives zeros and says so at the end.
#pragma once

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace raysteer::proto::lut {

class ByteWriter {
 public:
  template <std::integral T>
  void put(T value) {
    auto bits = static_cast<std::make_unsigned_t<T>>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bytes_.push_back(static_cast<std::uint8_t>(bits & 0xffU));
      if constexpr (sizeof(T) > 1) {
        bits = static_cast<std::make_unsigned_t<T>>(bits >> 8U);
      }
    }
  }
  void put(double value) { put(std::bit_cast<std::uint64_t>(value)); }
  void put(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  /// One byte of length, then the text.
  void put_name(std::string_view text) {
    put(static_cast<std::uint8_t>(text.size()));
    bytes_.insert(bytes_.end(), text.begin(), text.end());
  }

  const std::vector<std::uint8_t>& bytes() const { return bytes_; }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  template <std::integral T>
  T take() {
    const std::span<const std::uint8_t> from = take_bytes(sizeof(T));
    std::make_unsigned_t<T> bits = 0;
    for (std::size_t i = 0; i < from.size(); ++i) {
      bits = static_cast<std::make_unsigned_t<T>>(bits | static_cast<std::make_unsigned_t<T>>(from[i]) << (8 * i));
    }
    return static_cast<T>(bits);
  }
  double take_double() { return std::bit_cast<double>(take<std::uint64_t>()); }
  /// Nothing when fewer are left.
  std::span<const std::uint8_t> take_bytes(std::size_t count) {
    if (!good_ || count > bytes_.size()) {
      good_ = false;
      return {};
    }
    const auto taken = bytes_.first(count);
    bytes_ = bytes_.subspan(count);
    return taken;
  }
  std::string take_name() {
    const auto text = take_bytes(take<std::uint8_t>());
    return {text.begin(), text.end()};
  }
  /// Can `count` things of `size` bytes each still come? Asked before room is made for them.
  bool has(std::uint64_t count, std::size_t size) {
    good_ = good_ && count <= bytes_.size() / size;
    return good_;
  }
  /// Never ran out, and nothing is left over.
  bool finished() const { return good_ && bytes_.empty(); }

 private:
  std::span<const std::uint8_t> bytes_;
  bool good_ = true;
};

}  // namespace raysteer::proto::lut
