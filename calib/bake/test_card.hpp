// pure: a card that shows at a glance whether a projection is straight, square and to size, and its panel pictures.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <functional>
#include <optional>

#include "hal/base/image.hpp"

namespace raysteer::calib::bake {

/// Frame, centimetre ticks along all sides, marks in the corners, a grid of 5 cm, a ring and a cross in the middle.
struct TestCard {
  double width_m = 0.5;
  double height_m = 0.3125;

  /// Light at a place, metres from the top left corner: 0 (dark; outside) to 1.
  double light(const Eigen::Vector2d& content) const;
};

/// Panel pixel to place on the card, metres; nothing where the card is not.
using ContentMap = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& x)>;

/// The panel picture of a card: each pixel is the mean of 6 x 6 samples of its square, the map taken affine within it,
/// made 8-bit for a projector whose light is code^gamma.
Image<std::uint8_t> panel_picture(const TestCard& card, const ContentMap& map, int panel_width, int panel_height,
                                  double gamma);

}  // namespace raysteer::calib::bake
