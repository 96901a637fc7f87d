// Formats without compression: PGM, BMP, and the header of raw frames.
#include <algorithm>
#include <cctype>
#include <optional>
#include <string>

#include "host/session/codec.hpp"

namespace raysteer::host::session {
namespace {

Error too_short(std::string_view kind, std::size_t wanted, std::size_t got) {
  return fail(RCode::kFileTruncated,
              std::string(kind) + ": " + std::to_string(wanted) + " bytes expected, got " + std::to_string(got));
}

// ---- PGM: "P5 width height maxval" and one white space, then pixels (netpbm's pgm(5)); '#' comments in the header.

struct PgmHeader {
  ImageHeader image;
  int largest = 0;
  std::size_t pixels_at = 0;
};

Result<PgmHeader> parse_pgm(Bytes bytes) {
  constexpr int kMostDigits = 8;
  std::size_t at = 2;
  int values[3] = {};
  for (int& value : values) {
    bool comment = false;
    while (at < bytes.size() && (comment || std::isspace(bytes[at]) != 0 || bytes[at] == '#')) {
      comment = bytes[at] == '#' || (comment && bytes[at] != '\n');
      ++at;
    }
    int digits = 0;
    for (; at < bytes.size() && bytes[at] >= '0' && bytes[at] <= '9'; ++at) {
      if (++digits > kMostDigits) {
        return fail(RCode::kFrameFormat, "PGM: a number in the header is too long");
      }
      value = 10 * value + (bytes[at] - '0');
    }
    if (at == bytes.size()) {
      return fail(RCode::kFileTruncated, "PGM: the file ends in its header");
    }
    if (digits == 0) {
      return fail(RCode::kFrameFormat, "PGM: the header is not 'P5 width height maxval'");
    }
  }
  if (std::isspace(bytes[at]) == 0 || values[2] < 1 || values[2] > 65535) {
    return fail(RCode::kFrameFormat, "PGM: maxval must be 1 to 65535, and one white space must follow it");
  }
  return PgmHeader{{ImageKind::kPgm, values[0], values[1], values[2] > 255 ? 16 : 8}, values[2], at + 1};
}

// ---- BMP: BITMAPFILEHEADER and BITMAPINFOHEADER or a later one that begins alike, uncompressed.

std::uint32_t get_u32(Bytes bytes, std::size_t at) {
  return bytes[at] | (std::uint32_t{bytes[at + 1]} << 8U) | (std::uint32_t{bytes[at + 2]} << 16U) |
         (std::uint32_t{bytes[at + 3]} << 24U);
}

struct BmpHeader {
  ImageHeader image;
  bool top_down = false;
  std::size_t bytes_per_pixel = 1;
  std::size_t row_bytes = 0;
  std::size_t palette_at = 0;
  std::size_t palette_colours = 0;
  std::size_t pixels_at = 0;
};

Result<BmpHeader> parse_bmp(Bytes bytes) {
  constexpr std::size_t kFileHeader = 14;
  constexpr std::size_t kInfoHeader = 40;
  if (bytes.size() < kFileHeader + kInfoHeader) {
    return too_short("BMP", kFileHeader + kInfoHeader, bytes.size());
  }
  const std::uint32_t info_size = get_u32(bytes, 14);
  const auto width = static_cast<std::int32_t>(get_u32(bytes, 18));
  const auto height = static_cast<std::int32_t>(get_u32(bytes, 22));
  const std::uint32_t planes_and_bits = get_u32(bytes, 26);
  const std::uint32_t bits = planes_and_bits >> 16U;
  const std::uint32_t compression = get_u32(bytes, 30);
  const std::uint32_t colours = get_u32(bytes, 46);
  if (info_size < kInfoHeader || info_size > 1024 || (bits != 8 && bits != 24) || compression != 0 || colours > 256) {
    return fail(RCode::kFrameFormat, "BMP: only uncompressed files of 8 or 24 bits are read, got " +
                                         std::to_string(bits) + " bits, compression " + std::to_string(compression));
  }
  constexpr std::int32_t kLargestSide = 1 << 28;
  if (width < 1 || width > kLargestSide || height == 0 || height > kLargestSide || height < -kLargestSide) {
    return fail(RCode::kFrameFormat, "BMP: the header says " + std::to_string(width) + " x " + std::to_string(height));
  }
  BmpHeader header;
  header.image = {ImageKind::kBmp, width, std::abs(height), 8};
  header.top_down = height < 0;
  header.bytes_per_pixel = bits / 8;
  header.row_bytes = (static_cast<std::size_t>(width) * header.bytes_per_pixel + 3) / 4 * 4;
  header.palette_at = kFileHeader + info_size;
  header.palette_colours = bits == 8 ? (colours == 0 ? 256 : colours) : 0;
  header.pixels_at = get_u32(bytes, 10);
  if (header.pixels_at < header.palette_at + 4 * header.palette_colours) {
    return fail(RCode::kFrameFormat, "BMP: the pixels begin inside the header");
  }
  return header;
}

}  // namespace

Result<ImageHeader> read_pgm_header(Bytes bytes) {
  const Result<PgmHeader> header = parse_pgm(bytes);
  if (!header) {
    return header.error();
  }
  const ImageHeader& image = header->image;
  const std::size_t wanted = header->pixels_at + static_cast<std::size_t>(image.width) *
                                                     static_cast<std::size_t>(image.height) *
                                                     static_cast<std::size_t>(image.bits / 8);
  if (bytes.size() < wanted) {
    return too_short("PGM", wanted, bytes.size());
  }
  return image;
}

Status decode_pgm(Bytes bytes, const ImageHeader& header, const Pixels& into) {
  const Result<PgmHeader> parsed = parse_pgm(bytes);
  if (!parsed) {
    return parsed.error();
  }
  const auto count = static_cast<std::size_t>(header.width) * static_cast<std::size_t>(header.height);
  const std::uint8_t* from = bytes.data() + parsed->pixels_at;
  if (std::holds_alternative<std::uint8_t*>(into)) {
    std::copy(from, from + count, std::get<std::uint8_t*>(into));
  } else {
    auto* to = std::get<std::uint16_t*>(into);
    for (std::size_t i = 0; i < count; ++i) {  // the most significant byte comes first
      to[i] = static_cast<std::uint16_t>((from[2 * i] << 8) | from[2 * i + 1]);
    }
  }
  return ok();
}

Result<ImageHeader> read_bmp_header(Bytes bytes) {
  const Result<BmpHeader> header = parse_bmp(bytes);
  if (!header) {
    return header.error();
  }
  const std::size_t wanted = header->pixels_at + header->row_bytes * static_cast<std::size_t>(header->image.height);
  if (bytes.size() < wanted) {
    return too_short("BMP", wanted, bytes.size());
  }
  return header->image;
}

Status decode_bmp(Bytes bytes, const ImageHeader& header, const Pixels& into) {
  const Result<BmpHeader> parsed = parse_bmp(bytes);
  if (!parsed) {
    return parsed.error();
  }
  const auto width = static_cast<std::size_t>(header.width);
  const auto height = static_cast<std::size_t>(header.height);
  std::uint8_t shades[256] = {};  // palette as grey
  for (std::size_t i = 0; i < parsed->palette_colours; ++i) {
    const std::uint8_t* blue = &bytes[parsed->palette_at + 4 * i];
    shades[i] = static_cast<std::uint8_t>(grey(blue[2], blue[1], blue[0]));
  }
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t stored = parsed->top_down ? y : height - 1 - y;
    const std::uint8_t* from = bytes.data() + parsed->pixels_at + stored * parsed->row_bytes;
    std::uint8_t* to = std::get<std::uint8_t*>(into) + y * width;
    for (std::size_t x = 0; x < width; ++x) {
      to[x] = parsed->bytes_per_pixel == 1
                  ? shades[from[x]]
                  : static_cast<std::uint8_t>(grey(from[3 * x + 2], from[3 * x + 1], from[3 * x]));
    }
  }
  return ok();
}

Result<ImageHeader> read_raw_header(Bytes bytes) {
  if (bytes.size() < proto::session::kRawHeaderBytes) {
    return too_short("raw frame", proto::session::kRawHeaderBytes, bytes.size());
  }
  const auto u16 = [&](std::size_t at) { return bytes[at] | (bytes[at + 1] << 8); };
  return ImageHeader{ImageKind::kRaw, u16(4), u16(6), u16(8)};
}

namespace {

template <class Pixel>
std::vector<std::uint8_t> encode_pgm_as(ImageView<const Pixel> pixels) {
  constexpr int kLargest = sizeof(Pixel) == 1 ? 255 : 65535;
  const std::string header = "P5\n" + std::to_string(pixels.width()) + " " + std::to_string(pixels.height()) + "\n" +
                             std::to_string(kLargest) + "\n";
  std::vector<std::uint8_t> bytes(header.begin(), header.end());
  for (int y = 0; y < pixels.height(); ++y) {
    for (const Pixel pixel : pixels.row_span(y)) {
      if constexpr (sizeof(Pixel) == 2) {
        bytes.push_back(static_cast<std::uint8_t>(pixel >> 8));
      }
      bytes.push_back(static_cast<std::uint8_t>(pixel & 0xff));
    }
  }
  return bytes;
}

}  // namespace

std::vector<std::uint8_t> encode_pgm(ImageView<const std::uint8_t> pixels) { return encode_pgm_as(pixels); }
std::vector<std::uint8_t> encode_pgm(ImageView<const std::uint16_t> pixels) { return encode_pgm_as(pixels); }

}  // namespace raysteer::host::session
