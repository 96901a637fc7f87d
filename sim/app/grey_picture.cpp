#include "sim/app/grey_picture.hpp"

#include <algorithm>
#include <cmath>

#include "sim/app/find_file.hpp"
#include "sim/scene/read_picture.hpp"

namespace raysteer::sim::app {

Result<Image<std::uint8_t>> read_grey(const std::filesystem::path& file) {
  const Result<std::string> bytes = read_text(file);
  if (!bytes) {
    return bytes.error();
  }
  const Result<Image<float>> grey = scene::read_picture(*bytes, file.string());
  if (!grey) {
    return grey.error();
  }
  Image<std::uint8_t> codes(grey->width(), grey->height());
  std::transform(grey->data(), grey->data() + grey->size(), codes.data(), [](float value) {
    return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)));
  });
  return codes;
}

}  // namespace raysteer::sim::app
