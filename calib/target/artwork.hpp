// Where a printed target is black: what `raysteer target print` draws, and what detect() looks for.
#pragma once

#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::calib::target {

/// Metres from the top left of the squares' area, x right, y down, seen from the printed side.
struct BlackRectangle {
  double x = 0, y = 0, width = 0, height = 0;
};

struct Artwork {
  double width_m = 0;  ///< of all squares, without a margin
  double height_m = 0;
  std::vector<BlackRectangle> black;  ///< touching, never overlapping
};

/// A chessboard's top-left square is black. A ChArUco target is drawn in `target.layout`, kAuto as kCurrent.
/// Errors: kBadValue (sizes, an unknown dictionary, one with too few markers), kTargetScaleMissing.
Result<Artwork> artwork(const TargetSpec& target);

}  // namespace raysteer::calib::target
