#include "sim/scene/read_picture.hpp"

#include <png.h>

#include <cstdint>
#include <vector>

namespace raysteer::sim::scene {

Result<Image<float>> read_picture(std::string_view bytes, const std::string& file) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto unreadable = [&] {
    const std::string message = png.message;
    png_image_free(&png);
    return fail(RCode::kTextureFormat, file + ": expected a PNG picture; " + message);
  };
  if (png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()) == 0) {
    return unreadable();
  }
  // deflate shrinks by 1032:1 at most (zlib's technical notes): a smaller file lies about its size.
  constexpr std::uint64_t kMostPixels = 64'000'000;
  constexpr std::uint64_t kMostExpansion = 1032;
  const std::uint64_t pixels = std::uint64_t{png.width} * png.height;
  if (pixels > kMostPixels || pixels / 8 > kMostExpansion * bytes.size()) {
    png_image_free(&png);
    return fail(RCode::kTextureFormat, file + ": " + std::to_string(png.width) + "x" + std::to_string(png.height) +
                                           " pixels are more than the 64 million allowed, or than the file can hold");
  }
  png.format = PNG_FORMAT_GRAY;
  std::vector<std::uint8_t> grey(pixels);
  const int width = static_cast<int>(png.width);
  const int height = static_cast<int>(png.height);
  if (png_image_finish_read(&png, nullptr, grey.data(), 0, nullptr) == 0) {
    return unreadable();
  }
  Image<float> albedo(width, height);
  for (std::size_t i = 0; i < grey.size(); ++i) {
    albedo.data()[i] = static_cast<float>(grey[i]) / 255.0F;
  }
  return albedo;
}

}  // namespace raysteer::sim::scene
