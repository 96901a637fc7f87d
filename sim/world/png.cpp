#include "sim/world/png.hpp"

#include <png.h>

#include <filesystem>
#include <fstream>

namespace raysteer::sim::world {

std::string to_png(ImageView<const std::uint8_t> picture) {
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(picture.width());
  header.height = static_cast<png_uint_32>(picture.height());
  header.format = PNG_FORMAT_GRAY;
  const auto stride = static_cast<png_int_32>(picture.stride());
  png_alloc_size_t size = 0;
  std::string bytes;
  if (png_image_write_get_memory_size(header, size, 0, picture.data(), stride, nullptr) != 0) {
    bytes.resize(size);
    if (png_image_write_to_memory(&header, bytes.data(), &size, 0, picture.data(), stride, nullptr) == 0) {
      size = 0;
    }
    bytes.resize(size);
  }
  png_image_free(&header);
  return bytes;
}

Status save_png(ImageView<const std::uint8_t> picture, const std::string& file) {
  const std::string bytes = to_png(picture);
  if (bytes.empty()) {
    return fail(RCode::kWriteFailed, file + ": libpng refused the picture");
  }
  const std::string unfinished = file + ".part";
  std::ofstream out(unfinished, std::ios::binary);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  std::error_code error;
  if (out) {
    std::filesystem::rename(unfinished, file, error);
  }
  if (!out || error) {
    std::filesystem::remove(unfinished, error);
    return fail(RCode::kWriteFailed, file);
  }
  return ok();
}

}  // namespace raysteer::sim::world
