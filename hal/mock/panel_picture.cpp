#include "hal/mock/panel_picture.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::hal::mock {

std::array<float, 256> panel_response(double gamma, double black) {
  std::array<float, 256> light{};
  for (int code = 0; code < 256; ++code) {
    light[static_cast<std::size_t>(code)] = static_cast<float>(black + (1 - black) * std::pow(code / 255.0, gamma));
  }
  return light;
}

namespace {

/// Patterns are asked for in light (hal/base/pattern.hpp); a device makes up for its own response: the code that comes
/// nearest.
std::uint8_t code_for(double value, const std::array<float, 256>& response) {
  const double light = response.front() + (response.back() - response.front()) * value;
  const auto above = std::ranges::lower_bound(response, light);
  if (above == response.begin() || above == response.end()) {
    return above == response.end() ? 255 : 0;
  }
  const auto nearest = *above - light < light - *(above - 1) ? above : above - 1;
  return static_cast<std::uint8_t>(nearest - response.begin());
}

}  // namespace

std::shared_ptr<const PanelPicture> pattern_picture(const Pattern& pattern, int width, int height,
                                                    const std::array<float, 256>& response) {
  auto picture = std::make_shared<PanelPicture>();
  picture->width = width;
  picture->height = height;
  picture->along = pattern.block.axis;
  const bool along_x = pattern.block.axis == Axis::kX;
  const int length = along_x ? width : height;
  for (int i = 0; i < length; ++i) {
    const double value = along_x ? pattern.value(i, 0) : pattern.value(0, i);
    picture->profile.push_back(code_for(value, response));
  }
  picture->response = response;
  return picture;
}

std::shared_ptr<const PanelPicture> content_picture(ImageView<const std::uint8_t> pixels,
                                                    const std::array<float, 256>& response) {
  auto picture = std::make_shared<PanelPicture>();
  picture->width = pixels.width();
  picture->height = pixels.height();
  picture->pixels = Image<std::uint8_t>::uninitialised(pixels.width(), pixels.height());
  for (int y = 0; y < pixels.height(); ++y) {
    std::ranges::copy(pixels.row_span(y), picture->pixels.row(y));
  }
  picture->response = response;
  return picture;
}

std::shared_ptr<const PanelPicture> flat_picture(std::uint8_t code, int width, int height,
                                                 const std::array<float, 256>& response) {
  auto picture = std::make_shared<PanelPicture>();
  picture->width = width;
  picture->height = height;
  picture->along = Axis::kX;
  picture->profile.assign(static_cast<std::size_t>(width), code);
  picture->response = response;
  return picture;
}

}  // namespace raysteer::hal::mock
