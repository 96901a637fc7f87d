// pure: what a pattern or a content picture puts on the panel, bit for bit, and what light that is.
#pragma once

#include <array>
#include <memory>

#include "hal/base/pattern.hpp"
#include "hal/mock/exposure.hpp"

namespace raysteer::hal::mock {

/// Light of each code: black + (1 - black) (code / 255)^gamma.
std::array<float, 256> panel_response(double gamma, double black);

/// round(255 value), as one profile: every pattern changes along one axis only.
std::shared_ptr<const PanelPicture> pattern_picture(const Pattern& pattern, int width, int height,
                                                    const std::array<float, 256>& response);
std::shared_ptr<const PanelPicture> content_picture(ImageView<const std::uint8_t> pixels,
                                                    const std::array<float, 256>& response);
/// All pixels alike.
std::shared_ptr<const PanelPicture> flat_picture(std::uint8_t code, int width, int height,
                                                 const std::array<float, 256>& response);

}  // namespace raysteer::hal::mock
