#include "proto/session/raw_frame.hpp"

#include <algorithm>
#include <string>

namespace raysteer::proto::session {
namespace {

// Header: magic, then little-endian u16 width, u16 height, u16 bits, and six bytes of zero.
void put_u16(std::uint8_t* to, unsigned value) {
  to[0] = static_cast<std::uint8_t>(value & 0xffU);
  to[1] = static_cast<std::uint8_t>(value >> 8U);
}

unsigned get_u16(const std::uint8_t* from) { return from[0] | (static_cast<unsigned>(from[1]) << 8U); }

template <class Pixel>
std::vector<std::uint8_t> write_as(ImageView<const Pixel> pixels) {
  const auto header = raw_header(pixels.width(), pixels.height(), 8 * sizeof(Pixel));
  const auto width = static_cast<std::size_t>(pixels.width());
  const auto height = static_cast<std::size_t>(pixels.height());
  std::vector<std::uint8_t> bytes(kRawHeaderBytes + width * height * sizeof(Pixel));
  std::ranges::copy(header, bytes.begin());
  std::uint8_t* to = bytes.data() + kRawHeaderBytes;
  for (int y = 0; y < pixels.height(); ++y) {
    for (const Pixel pixel : pixels.row_span(y)) {
      if constexpr (sizeof(Pixel) == 1) {
        *to = pixel;
      } else {
        put_u16(to, pixel);
      }
      to += sizeof(Pixel);
    }
  }
  return bytes;
}

template <class Pixel>
Frame read_as(const std::uint8_t* from, int width, int height) {
  auto image = Image<Pixel>::uninitialised(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.data()[i] = static_cast<Pixel>(sizeof(Pixel) == 1 ? from[i] : get_u16(from + 2 * i));
  }
  return image;
}

}  // namespace

std::array<std::uint8_t, kRawHeaderBytes> raw_header(int width, int height, int bits) {
  constexpr int kLargestSide = 65535;
  RAYSTEER_CHECK(width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide);
  RAYSTEER_CHECK(bits == 8 || bits == 16);
  std::array<std::uint8_t, kRawHeaderBytes> bytes{};
  std::ranges::copy(kRawMagic, bytes.begin());
  put_u16(&bytes[4], static_cast<unsigned>(width));
  put_u16(&bytes[6], static_cast<unsigned>(height));
  put_u16(&bytes[8], static_cast<unsigned>(bits));
  return bytes;
}

std::vector<std::uint8_t> write_raw_frame(ImageView<const std::uint8_t> pixels) { return write_as(pixels); }
std::vector<std::uint8_t> write_raw_frame(ImageView<const std::uint16_t> pixels) { return write_as(pixels); }

Result<Frame> read_raw_frame(std::span<const std::uint8_t> bytes) {
  const std::size_t compared = std::min(bytes.size(), std::size(kRawMagic));
  if (!std::equal(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(compared), kRawMagic)) {
    return fail(RCode::kFrameFormat, "a raw frame begins with 'RSF1'");
  }
  if (bytes.size() < kRawHeaderBytes) {
    return fail(RCode::kFileTruncated, "a raw frame's header has 16 bytes, got " + std::to_string(bytes.size()));
  }
  const unsigned width = get_u16(&bytes[4]);
  const unsigned height = get_u16(&bytes[6]);
  const unsigned bits = get_u16(&bytes[8]);
  const bool reserved_used = std::any_of(&bytes[10], &bytes[16], [](std::uint8_t byte) { return byte != 0; });
  if (width == 0 || height == 0 || (bits != 8 && bits != 16) || reserved_used) {
    return fail(RCode::kFrameFormat, "the raw frame's header says " + std::to_string(width) + " x " +
                                         std::to_string(height) + " px of " + std::to_string(bits) +
                                         " bits; expected 1 to 65535 px, 8 or 16 bits, and zeros in bytes 10 to 15");
  }
  const std::size_t wanted = kRawHeaderBytes + std::size_t{width} * height * (bits / 8);
  if (bytes.size() != wanted) {
    return fail(
        bytes.size() < wanted ? RCode::kFileTruncated : RCode::kFrameFormat,
        "a raw frame of this size has " + std::to_string(wanted) + " bytes, got " + std::to_string(bytes.size()));
  }
  const std::uint8_t* pixels = bytes.data() + kRawHeaderBytes;
  return bits == 8 ? read_as<std::uint8_t>(pixels, static_cast<int>(width), static_cast<int>(height))
                   : read_as<std::uint16_t>(pixels, static_cast<int>(width), static_cast<int>(height));
}

}  // namespace raysteer::proto::session
