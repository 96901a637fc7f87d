// From decoded projector coordinates to what a projector "saw" of a target. No homographies, local or global: the
// step of Moreno and Taubin is reported as patented (algorithms 3.2), and measured pixels go into the adjustment as
// they are.
#pragma once

#include <span>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "calib/solve/observations.hpp"
#include "calib/target/target_geometry.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::calib::solve {

struct Correspondences {
  /// Panel pixel that lights each corner: weighted least squares of a quadratic in the camera pixel over the decoded
  /// pixels of the squares around it (its value at the corner), with its sigma. Corners with too little around are left
  /// out.
  std::vector<target::Corner> panel_corners;
  /// Single decoded pixels spread evenly over the squares, at least 2 px from their borders.
  std::vector<DecodedPixel> pixels;
};

/// Fewest decoded pixels a view must have on the target (algorithms 3.2).
constexpr int kFewestPixels = 300;

/// `corners` as detected in the camera that `map` belongs to; `camera` is its index in Observations. `target.layout` is
/// the one found. Errors: kTooFewCorrespondences.
Result<Correspondences> correspondences(const decode::CodeMap& map, const TargetSpec& target,
                                        std::span<const target::Corner> corners, int camera = 0);

}  // namespace raysteer::calib::solve
