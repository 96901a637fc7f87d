// pure: colour pixels as a PNG file.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysteer::host::report {

/// Bytes of a PNG of 8-bit RGB pixels, row by row; empty when libpng gives up.
std::string encode_rgb_png(std::span<const std::uint8_t> rgb, int width, int height);

}  // namespace raysteer::host::report
