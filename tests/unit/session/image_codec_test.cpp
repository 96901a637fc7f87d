#include "host/session/image_codec.hpp"

#include <gtest/gtest.h>
#include <turbojpeg.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "proto/session/raw_frame.hpp"

namespace raysteer::host::session {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <class Pixel>
Image<Pixel> ramp(int width, int height, unsigned step) {
  Image<Pixel> image(width, height);
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.data()[i] = static_cast<Pixel>(i * step + 1);
  }
  return image;
}

template <class Pixel>
void expect_same(const Result<Frame>& frame, const Image<Pixel>& image) {
  ASSERT_TRUE(frame) << frame.error().message();
  ASSERT_TRUE(std::holds_alternative<Image<Pixel>>(*frame));
  const auto& got = std::get<Image<Pixel>>(*frame);
  ASSERT_EQ(got.width(), image.width());
  ASSERT_EQ(got.height(), image.height());
  EXPECT_TRUE(std::equal(image.data(), image.data() + image.size(), got.data()));
}

Bytes jpeg(const Image<std::uint8_t>& image) {
  tjhandle handle = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long size = 0;
  tjCompress2(handle, image.data(), image.width(), 0, image.height(), TJPF_GRAY, &out, &size, TJSAMP_GRAY, 95, 0);
  Bytes bytes(out, out + size);
  tjFree(out);
  tjDestroy(handle);
  return bytes;
}

void put(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
}

// 3 x 2 px, bottom-up, rows padded to four bytes.
Bytes bmp(int bits, std::int32_t height = 2) {
  const std::uint32_t palette = bits == 8 ? 256 : 0;
  const std::uint32_t pixels_at = 54 + 4 * palette;
  const std::uint32_t row = bits == 8 ? 4 : 12;
  Bytes bytes{'B', 'M'};
  put(bytes, pixels_at + 2 * row, 4);
  put(bytes, 0, 4);
  put(bytes, pixels_at, 4);
  put(bytes, 40, 4);
  put(bytes, 3, 4);
  put(bytes, static_cast<std::uint32_t>(height), 4);
  put(bytes, 1, 2);
  put(bytes, static_cast<std::uint32_t>(bits), 2);
  put(bytes, 0, 4);
  put(bytes, 0, 4);
  put(bytes, 0, 4);
  put(bytes, 0, 4);
  put(bytes, 0, 4);
  put(bytes, 0, 4);
  for (std::uint32_t i = 0; i < palette; ++i) {
    put(bytes, i * 0x010101, 4);
  }
  for (std::uint32_t y = 0; y < 2; ++y) {
    for (std::uint32_t x = 0; x < 3; ++x) {
      put(bytes, (10 * y + x) * 0x010101, bits / 8);
    }
    put(bytes, 0, static_cast<int>(row) - 3 * bits / 8);
  }
  return bytes;
}

struct Sample {
  std::string name;
  Bytes bytes;
};

std::vector<Sample> samples() {
  const Image<std::uint8_t> narrow = ramp<std::uint8_t>(13, 9, 7);
  const Image<std::uint16_t> wide = ramp<std::uint16_t>(11, 5, 1001);
  return {{"png 8", *encode_png(narrow.view())},
          {"png 16", *encode_png(wide.view())},
          {"pgm 8", encode_pgm(narrow.view())},
          {"pgm 16", encode_pgm(wide.view())},
          {"raw 8", proto::session::write_raw_frame(narrow.view())},
          {"raw 16", proto::session::write_raw_frame(wide.view())},
          {"jpeg", jpeg(narrow)},
          {"bmp 8", bmp(8)},
          {"bmp 24", bmp(24)}};
}

TEST(ImageCodec, lossless_kinds_give_back_the_same_pixels) {
  const Image<std::uint8_t> narrow = ramp<std::uint8_t>(13, 9, 7);
  const Image<std::uint16_t> wide = ramp<std::uint16_t>(11, 5, 1001);
  expect_same(decode_image(*encode_png(narrow.view())), narrow);
  expect_same(decode_image(*encode_png(wide.view())), wide);
  expect_same(decode_image(encode_pgm(narrow.view())), narrow);
  expect_same(decode_image(encode_pgm(wide.view())), wide);
  expect_same(decode_image(proto::session::write_raw_frame(narrow.view())), narrow);
  expect_same(decode_image(proto::session::write_raw_frame(wide.view())), wide);
}

TEST(ImageCodec, jpeg_is_read_as_grey_within_its_loss) {
  Image<std::uint8_t> image(32, 16);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      image(x, y) = static_cast<std::uint8_t>(40 + 5 * x + y);
    }
  }
  const Result<Frame> frame = decode_image(jpeg(image));
  ASSERT_TRUE(frame) << frame.error().message();
  const auto& got = std::get<Image<std::uint8_t>>(*frame);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      EXPECT_NEAR(got(x, y), image(x, y), 3);
    }
  }
}

TEST(ImageCodec, bmp_is_read_bottom_up_and_top_down) {
  for (const int bits : {8, 24}) {
    for (const std::int32_t height : {2, -2}) {
      const Result<Frame> frame = decode_image(bmp(bits, height));
      ASSERT_TRUE(frame) << frame.error().message();
      const auto& got = std::get<Image<std::uint8_t>>(*frame);
      ASSERT_EQ(got.width(), 3);
      ASSERT_EQ(got.height(), 2);
      const int stored_first = height > 0 ? 1 : 0;
      EXPECT_EQ(got(2, stored_first), 2);
      EXPECT_EQ(got(1, 1 - stored_first), 11);
    }
  }
}

TEST(ImageCodec, a_file_cut_anywhere_is_refused) {
  for (const Sample& sample : samples()) {
    ASSERT_TRUE(decode_image(sample.bytes)) << sample.name << ": " << decode_image(sample.bytes).error().message();
    for (std::size_t size = 0; size < sample.bytes.size(); ++size) {
      const Result<Frame> frame = decode_image(std::span(sample.bytes).first(size));
      ASSERT_FALSE(frame) << sample.name << " of " << sample.bytes.size() << " bytes, cut at " << size;
      const RCode rcode = frame.error().rcode;
      EXPECT_TRUE(rcode == RCode::kFileTruncated || rcode == RCode::kFrameFormat)
          << sample.name << " at " << size << ": " << frame.error().message();
    }
    const Result<Frame> half = decode_image(std::span(sample.bytes).first(sample.bytes.size() - 3));
    EXPECT_EQ(half.error().rcode, RCode::kFileTruncated) << sample.name << ": " << half.error().message();
  }
}

TEST(ImageCodec, any_changed_byte_is_survived) {
  for (const Sample& sample : samples()) {
    Bytes bytes = sample.bytes;
    for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 200); ++i) {
      for (const int change : {1, 0x80, 0xff}) {
        bytes[i] = static_cast<std::uint8_t>(bytes[i] ^ change);
        const Result<ImageHeader> header = read_header(bytes);
        if (header && std::int64_t{header->width} * header->height < 1 << 20) {
          (void)decode_image(bytes);
        }
        bytes[i] = sample.bytes[i];
      }
    }
  }
}

TEST(ImageCodec, depth_other_than_asked_is_refused) {
  Image<std::uint8_t> narrow;
  Image<std::uint16_t> wide;
  const Bytes eight = *encode_png(ramp<std::uint8_t>(4, 4, 1).view());
  const Bytes sixteen = encode_pgm(ramp<std::uint16_t>(4, 4, 500).view());
  EXPECT_EQ(decode_image(sixteen, narrow).error().rcode, RCode::kFrameDepth);
  EXPECT_EQ(decode_image(eight, wide).error().rcode, RCode::kFrameDepth);
  EXPECT_TRUE(decode_image(eight, narrow));
  EXPECT_TRUE(decode_image(sixteen, wide));
}

TEST(ImageCodec, a_header_that_promises_too_much_takes_no_memory) {
  Bytes pgm;
  for (const char c : std::string("P5 60000 60000 255 ")) {
    pgm.push_back(static_cast<std::uint8_t>(c));
  }
  EXPECT_FALSE(decode_image(pgm));
  Bytes raw = proto::session::write_raw_frame(ramp<std::uint8_t>(2, 2, 1).view());
  raw[5] = 0xff;
  raw[7] = 0xff;
  EXPECT_FALSE(decode_image(raw));
}

TEST(ImageCodec, other_files_are_named_as_such) {
  const std::string text = "this is no picture at all";
  const Result<Frame> frame = decode_image(Bytes(text.begin(), text.end()));
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().rcode, RCode::kFrameFormat);
}

}  // namespace
}  // namespace raysteer::host::session
