// pure: PNG pictures as albedo.
#pragma once

#include <string>
#include <string_view>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::sim::scene {

/// Grey of each pixel over 255 (colours by their luminance), taken as albedo as it stands. kTextureFormat: no PNG, or
/// one of more than 64 million pixels.
Result<Image<float>> read_picture(std::string_view bytes, const std::string& file);

}  // namespace raysteer::sim::scene
