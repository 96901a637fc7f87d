// value: a rectangle of whole pixels within an image, and what an image shows there.
#pragma once

#include "hal/base/image.hpp"

namespace raysteer {

/// Columns [x, x + width), rows [y, y + height).
struct Region {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;

  bool operator==(const Region&) const = default;
};

/// The region lies within the image.
template <class T>
constexpr ImageView<T> part(ImageView<T> image, const Region& region) {
  return {image.row(region.y) + region.x, region.width, region.height, image.stride()};
}

}  // namespace raysteer
