// pure: grey pictures as PNG.
#pragma once

#include <cstdint>
#include <string>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::sim::world {

/// The file's bytes; 8 bits, grey.
std::string to_png(ImageView<const std::uint8_t> picture);

/// Writes the file whole or not at all. kWriteFailed.
Status save_png(ImageView<const std::uint8_t> picture, const std::string& file);

}  // namespace raysteer::sim::world
