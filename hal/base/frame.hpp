// value: one picture of one camera.
#pragma once

#include <cstdint>
#include <variant>

#include "hal/base/image.hpp"

namespace raysteer {

/// Grey pixels as a camera gives them: 8 bits, or 9 to 16 in 16.
using Frame = std::variant<Image<std::uint8_t>, Image<std::uint16_t>>;

}  // namespace raysteer
