// value: the directions in which a camera's pixels look, row by row, faster than inverting its lens for each.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/optics/true_rig.hpp"

namespace raysteer::sim::world {

class CameraRays {
 public:
  explicit CameraRays(const optics::TrueCamera& camera) : camera_(camera) {}

  struct Row {
    std::vector<Eigen::Vector3d> ray;   ///< of each pixel's centre, rig frame; unit to 1e-9
    std::vector<Eigen::Vector3d> down;  ///< what one pixel down adds to it
  };
  /// Exact every 16 pixels and cubic in between: off by 1e-9 rad at most for lenses whose distortion is a few per cent.
  void row(int y, Row& out) const;

  /// What one pixel to the right adds to a row's ray.
  static Eigen::Vector3d across(const Row& row, int x) {
    const auto at = static_cast<std::size_t>(x);
    return x + 1 < static_cast<int>(row.ray.size()) ? row.ray[at + 1] - row.ray[at] : row.ray[at] - row.ray[at - 1];
  }

 private:
  optics::TrueCamera camera_;
};

}  // namespace raysteer::sim::world
