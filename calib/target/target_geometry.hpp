// value: where the corners of a target are, in the target's own frame.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "hal/base/target.hpp"

namespace raysteer::calib::target {

/// One detected corner: which one, where, how sure.
struct Corner {
  int id = 0;           ///< row * corner_columns + column, from the target's origin corner
  Eigen::Vector2d q;    ///< camera px
  double sigma_px = 0;  ///< per coordinate
};

/// One target in one camera's frame.
struct Detection {
  std::vector<Corner> corners;
  CharucoLayout layout = CharucoLayout::kAuto;  ///< ChArUco: the layout that fitted
  double sharpness_px = 0;                      ///< edge blur sigma at the corners, camera px
};

/// Position of corner `id`, metres: x along columns, y along rows, z = 0.
inline Eigen::Vector3d corner_position(const TargetSpec& target, int id) {
  return {target.square_m * (id % target.corner_columns()), target.square_m * (id / target.corner_columns()), 0};
}

}  // namespace raysteer::calib::target
