#include <png.h>

#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "host/session/codec.hpp"

namespace raysteer::host::session {
namespace {

// deflate cannot shrink data by more than 1032:1 (zlib's technical notes), so a file this much smaller than its
// pixels is cut short or lies about its size; found out before the pixels' memory is asked for.
constexpr std::size_t kMostExpansion = 1032;

struct Source {
  Bytes bytes;
  std::size_t at = 0;
  bool short_of_bytes = false;
  std::array<char, 160> message{};
};

// libpng reports by jumping back to setjmp(): between there and here nothing may own anything.
[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  auto* source = static_cast<Source*>(png_get_error_ptr(png));
  std::strncpy(source->message.data(), message, source->message.size() - 1);
  longjmp(png_jmpbuf(png), 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_read(png_structp png, png_bytep to, std::size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (count > source->bytes.size() - source->at) {
    source->short_of_bytes = true;
    png_error(png, "the file ends too early");
  }
  std::memcpy(to, source->bytes.data() + source->at, count);
  source->at += count;
}

class Reader {
 public:
  explicit Reader(Bytes bytes) : source_{.bytes = bytes} {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source_, on_error, on_warning);
    info_ = png_ != nullptr ? png_create_info_struct(png_) : nullptr;
    if (info_ != nullptr) {
      png_set_read_fn(png_, &source_, on_read);
      // A chunk of text or a colour profile may claim any size; frames need neither.
      png_set_chunk_malloc_max(png_, 8'000'000);
    }
  }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;
  ~Reader() { png_destroy_read_struct(&png_, &info_, nullptr); }

  // Everything that can jump is in these two; their locals are plain.
  bool read_info() {
    if (info_ == nullptr || setjmp(png_jmpbuf(png_)) != 0) {
      return false;
    }
    png_read_info(png_, info_);
    return true;
  }
  bool read_pixels(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png_)) != 0) {
      return false;
    }
    png_read_image(png_, rows);
    png_read_end(png_, nullptr);
    return true;
  }
  /// To 8 or 16 bits, grey or RGB, in this machine's byte order. Gives the bytes of a row; 0 on failure.
  std::size_t normalise() {
    if (setjmp(png_jmpbuf(png_)) != 0) {
      return 0;
    }
    png_set_expand(png_);  // palette to RGB, 1-4 bits to 8, transparency to alpha
    png_set_strip_alpha(png_);
    if (png_get_bit_depth(png_, info_) == 16) {
      png_set_swap(png_);
    }
    png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
    return png_get_rowbytes(png_, info_);
  }

  ImageHeader header() const {
    // A size beyond int becomes 0, which check_header() refuses.
    const auto side = [](png_uint_32 value) { return value > 0x7fffffffU ? 0 : static_cast<int>(value); };
    return {.kind = ImageKind::kPng,
            .width = side(png_get_image_width(png_, info_)),
            .height = side(png_get_image_height(png_, info_)),
            .bits = png_get_bit_depth(png_, info_) == 16 ? 16 : 8};
  }
  int channels() const { return png_get_channels(png_, info_); }
  Error error() const {
    return fail(source_.short_of_bytes ? RCode::kFileTruncated : RCode::kFrameFormat,
                std::string("PNG: ") + source_.message.data());
  }

 private:
  Source source_;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
};

template <class Pixel>
Status decode_as(Reader& reader, Bytes bytes, const ImageHeader& header, Pixel* into) {
  const auto height = static_cast<std::size_t>(header.height);
  const auto width = static_cast<std::size_t>(header.width);
  const std::size_t row_bytes = reader.normalise();
  if (row_bytes == 0) {
    return reader.error();
  }
  const auto channels = static_cast<std::size_t>(reader.channels());
  if (row_bytes != width * channels * sizeof(Pixel) || (channels != 1 && channels != 3)) {
    return fail(RCode::kFrameFormat, "PNG: neither grey nor colour");
  }
  // An eighth: the file may have had 1 bit a pixel.
  if (row_bytes * height / 8 / kMostExpansion > bytes.size()) {
    return fail(RCode::kFileTruncated, "PNG: " + std::to_string(bytes.size()) + " bytes cannot hold " +
                                           std::to_string(width) + " x " + std::to_string(height) + " px");
  }
  std::vector<Pixel> colours(channels == 3 ? 3 * width * height : 0);
  auto* first = channels == 3 ? colours.data() : into;
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) {
    rows[y] = reinterpret_cast<png_bytep>(first + y * width * channels);
  }
  if (!reader.read_pixels(rows.data())) {
    return reader.error();
  }
  for (std::size_t i = 0; i < colours.size() / 3; ++i) {
    into[i] = static_cast<Pixel>(grey(colours[3 * i], colours[3 * i + 1], colours[3 * i + 2]));
  }
  return ok();
}

void on_write(png_structp png, png_bytep from, std::size_t count) {
  auto* bytes = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
  bytes->insert(bytes->end(), from, from + count);
}

void on_flush(png_structp) {}

bool write_rows(png_structp png, png_infop info, int width, int height, int bits, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) {
    return false;
  }
  png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height), bits, PNG_COLOR_TYPE_GRAY,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 1);
  png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
  png_write_info(png, info);
  if (bits == 16) {
    png_set_swap(png);
  }
  png_write_image(png, rows);
  png_write_end(png, info);
  return true;
}

template <class Pixel>
Result<std::vector<std::uint8_t>> encode_as(ImageView<const Pixel> pixels) {
  if (pixels.empty()) {
    return fail(RCode::kBadValue, "PNG: an image without pixels");
  }
  std::vector<png_bytep> rows;
  for (int y = 0; y < pixels.height(); ++y) {
    // libpng wants changeable rows and leaves them unchanged.
    rows.push_back(reinterpret_cast<png_bytep>(const_cast<Pixel*>(pixels.row(y))));
  }
  std::vector<std::uint8_t> bytes;
  Source messages;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &messages, on_error, on_warning);
  png_infop info = png != nullptr ? png_create_info_struct(png) : nullptr;
  bool written = false;
  if (info != nullptr) {
    png_set_write_fn(png, &bytes, on_write, on_flush);
    written = write_rows(png, info, pixels.width(), pixels.height(), 8 * static_cast<int>(sizeof(Pixel)), rows.data());
  }
  png_destroy_write_struct(&png, &info);
  if (!written) {
    return fail(RCode::kWriteFailed, std::string("PNG: ") + messages.message.data());
  }
  return bytes;
}

}  // namespace

Result<ImageHeader> read_png_header(Bytes bytes) {
  Reader reader(bytes);
  if (!reader.read_info()) {
    return reader.error();
  }
  return reader.header();
}

Status decode_png(Bytes bytes, const ImageHeader& header, const Pixels& into) {
  Reader reader(bytes);
  if (!reader.read_info()) {
    return reader.error();
  }
  return std::visit([&](auto* pixels) { return decode_as(reader, bytes, header, pixels); }, into);
}

Result<std::vector<std::uint8_t>> encode_png(ImageView<const std::uint8_t> pixels) { return encode_as(pixels); }
Result<std::vector<std::uint8_t>> encode_png(ImageView<const std::uint16_t> pixels) { return encode_as(pixels); }

}  // namespace raysteer::host::session
