// pure: content pictures.
#pragma once

#include <filesystem>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::sim::app {

/// A PNG as 8-bit grey. kFileMissing, kFileUnreadable, kTextureFormat.
Result<Image<std::uint8_t>> read_grey(const std::filesystem::path& file);

}  // namespace raysteer::sim::app
