// pure: baked tables asked one pixel at a time, and results that must be there.
#pragma once

#include <memory>
#include <stdexcept>

#include "proto/lut/evaluate.hpp"

namespace raysteer::calib::bake {

template <class T>
T valid(Result<T> result) {
  if (!result) {
    throw std::runtime_error(result.error().message());
  }
  return std::move(*result);
}

struct LookedUp {
  double u = 0;
  double v = 0;
  double gain = 0;  ///< 0: shows nothing
};

/// Pixel by pixel, each cell evaluated once.
class Lookup {
 public:
  explicit Lookup(const proto::lut::WarpMap& map)
      : map_(map), tiles_(static_cast<std::size_t>(map.columns() * map.rows())) {}
  LookedUp operator()(int x, int y) {
    const int column = x / map_.parts().cell_px;
    const int row = y / map_.parts().cell_px;
    auto& tile = tiles_[static_cast<std::size_t>(row * map_.columns() + column)];
    if (!tile) {
      tile = std::make_unique<proto::lut::WarpTile>();
      evaluate(map_, column, row, *tile);
    }
    if (tile->empty) {
      return {};
    }
    const std::size_t at = proto::lut::WarpTile::at(x - tile->x, y - tile->y);
    return {.u = tile->u[at] / double{proto::lut::kSubPixel},
            .v = tile->v[at] / double{proto::lut::kSubPixel},
            .gain = tile->gain[at] / double{proto::lut::kFullGain}};
  }

 private:
  const proto::lut::WarpMap& map_;
  std::vector<std::unique_ptr<proto::lut::WarpTile>> tiles_;
};

}  // namespace raysteer::calib::bake
