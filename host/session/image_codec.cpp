#include "host/session/image_codec.hpp"

#include <algorithm>
#include <string>
#include <type_traits>
#include <utility>

#include "host/session/codec.hpp"

namespace raysteer::host::session {
namespace {

ImageKind kind_of(Bytes bytes) {
  const auto begins = [&](std::initializer_list<std::uint8_t> magic) {
    return bytes.size() >= magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (begins({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'})) {
    return ImageKind::kPng;
  }
  if (begins({0xff, 0xd8, 0xff})) {
    return ImageKind::kJpeg;
  }
  if (begins({'P', '5'})) {
    return ImageKind::kPgm;
  }
  if (begins({'B', 'M'})) {
    return ImageKind::kBmp;
  }
  if (begins({'R', 'S', 'F', '1'})) {
    return ImageKind::kRaw;
  }
  return ImageKind::kUnknown;
}

// A file cut within its first bytes is short rather than of an unknown kind.
Error unknown_kind(Bytes bytes) {
  constexpr std::size_t kLongestMagic = 8;
  if (bytes.size() < kLongestMagic) {
    return fail(RCode::kFileTruncated, "only " + std::to_string(bytes.size()) + " bytes");
  }
  return fail(RCode::kFrameFormat, "the first bytes are none of PNG, JPEG, binary PGM, BMP or raw frame");
}

Status check_header(const ImageHeader& header) {
  if (header.width < 1 || header.height < 1 || std::int64_t{header.width} * std::int64_t{header.height} > kMostPixels) {
    return fail(RCode::kFrameFormat, "the header says " + std::to_string(header.width) + " x " +
                                         std::to_string(header.height) + " px; 1 to 2^28 px are accepted");
  }
  return ok();
}

Status decode_pixels(Bytes bytes, const ImageHeader& header, const Pixels& into) {
  switch (header.kind) {
    case ImageKind::kPng:
      return decode_png(bytes, header, into);
    case ImageKind::kJpeg:
      return decode_jpeg(bytes, header, into);
    case ImageKind::kPgm:
      return decode_pgm(bytes, header, into);
    case ImageKind::kBmp:
      return decode_bmp(bytes, header, into);
    case ImageKind::kRaw:
    case ImageKind::kUnknown:
      break;
  }
  return unknown_kind(bytes);
}

template <class Pixel>
Status decode_into(Bytes bytes, Image<Pixel>& into) {
  constexpr int kBits = 8 * static_cast<int>(sizeof(Pixel));
  const Result<ImageHeader> header = read_header(bytes);
  if (!header) {
    return header.error();
  }
  if (header->bits != kBits) {
    return fail(RCode::kFrameDepth,
                "the file holds " + std::to_string(header->bits) + " bits, expected " + std::to_string(kBits));
  }
  if (header->kind == ImageKind::kRaw) {
    Result<Frame> frame = proto::session::read_raw_frame(bytes);
    if (!frame) {
      return std::move(frame).error();
    }
    into = std::get<Image<Pixel>>(std::move(*frame));
    return ok();
  }
  if (into.width() != header->width || into.height() != header->height) {
    into = Image<Pixel>::uninitialised(header->width, header->height);
  }
  return decode_pixels(bytes, *header, Pixels{into.data()});
}

}  // namespace

Result<ImageHeader> read_header(Bytes bytes) {
  Result<ImageHeader> header = [&]() -> Result<ImageHeader> {
    switch (kind_of(bytes)) {
      case ImageKind::kPng:
        return read_png_header(bytes);
      case ImageKind::kJpeg:
        return read_jpeg_header(bytes);
      case ImageKind::kPgm:
        return read_pgm_header(bytes);
      case ImageKind::kBmp:
        return read_bmp_header(bytes);
      case ImageKind::kRaw:
        return read_raw_header(bytes);
      case ImageKind::kUnknown:
        break;
    }
    return unknown_kind(bytes);
  }();
  if (header) {
    RAYSTEER_TRY(check_header(*header));
  }
  return header;
}

Status decode_image(Bytes bytes, Image<std::uint8_t>& into) { return decode_into(bytes, into); }
Status decode_image(Bytes bytes, Image<std::uint16_t>& into) { return decode_into(bytes, into); }

Result<Frame> decode_image(Bytes bytes) {
  const Result<ImageHeader> header = read_header(bytes);
  if (!header) {
    return header.error();
  }
  if (header->bits == 8) {
    Image<std::uint8_t> image;
    RAYSTEER_TRY(decode_image(bytes, image));
    return Frame(std::move(image));
  }
  Image<std::uint16_t> image;
  RAYSTEER_TRY(decode_image(bytes, image));
  return Frame(std::move(image));
}

}  // namespace raysteer::host::session
