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
    picture->profile.push_back(static_cast<std::uint8_t>(std::lround(255 * value)));
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
