// pure: the content coordinates of a cell's pixels. The device shows with it, and bake checks with it.
#pragma once

#include <array>
#include <cstdint>

#include "proto/lut/warp_map.hpp"

namespace raysteer::proto::lut {

/// Rows lie kLargestCell apart. What lies beyond width and height is not set.
struct WarpTile {
  int x = 0;  ///< panel pixel of the first
  int y = 0;
  int width = 0;  ///< pixels; less than the cell at the panel's right and lower edge
  int height = 0;
  bool empty = true;  ///< no pixel shows anything; then the arrays are not set
  /// Content pixels times kSubPixel, from one pixel before the content to one after: content ends in black, so that its
  /// edges are soft. Zero where a pixel shows nothing.
  std::array<std::int32_t, kLargestCell * kLargestCell> u;
  std::array<std::int32_t, kLargestCell * kLargestCell> v;
  /// Of linear light, times kFullGain. Zero exactly where a pixel shows nothing.
  std::array<std::uint16_t, kLargestCell * kLargestCell> gain;

  static std::size_t at(int column, int row) { return static_cast<std::size_t>(row * kLargestCell + column); }
};

/// Cell (column, row) of a map. Never allocates; any map that make() let pass gives coordinates within the limits
/// above. The same numbers on every machine.
void evaluate(const WarpMap& map, int column, int row, WarpTile& tile);

}  // namespace raysteer::proto::lut
