// pure: where in a camera's image is the projector's light? The picture may cover a small part of the view.
#pragma once

#include <cstdint>

#include "hal/base/image.hpp"
#include "hal/base/region.hpp"

namespace raysteer::calib::decode {

/// The smallest rectangle, camera px, that holds what white lights and black does not, but for stray reflections; the
/// whole image where that is next to nothing. Both images have one size.
Region lit_region(ImageView<const std::uint8_t> white, ImageView<const std::uint8_t> black);
Region lit_region(ImageView<const std::uint16_t> white, ImageView<const std::uint16_t> black);

}  // namespace raysteer::calib::decode
