// value: which of the panel's rays leave the rig at one command: those that meet every mirror within its outline.
//
// Where a ray (n_x, n_y, 1) of the lens meets a mirror is a homography of n, so every question here is a comparison of
// linear forms.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "calib/model/steered_projector.hpp"

namespace raysteer::calib::bake {

class MirrorWindow {
 public:
  /// A mirror whose size_m is zero has no edge.
  MirrorWindow(const model::SteeredProjector& projector, const Eigen::Vector2d& command_rad);

  /// `m`: (X/Z, Y/Z, 1) in the lens's frame.
  bool passes(const Eigen::Vector3d& m) const;
  /// 1 / s of the last mirror, where s is counted in lengths of `m` from the lens: light exists only behind it.
  double inverse_exit(const Eigen::Vector3d& m) const {
    return meets_[static_cast<std::size_t>(count_ - 1)].inverse.dot(m);
  }

 private:
  /// Forms in m: where the ray meets a mirror's plane.
  struct Meeting {
    Eigen::Vector3d front;    ///< positive on the mirror's face
    Eigen::Vector3d inverse;  ///< 1/s
    Eigen::Vector3d across;   ///< place in the mirror over its half size, times 1/s
    Eigen::Vector3d along;
    bool bounded = true;
    bool ellipse = true;

    bool in_outline(const Eigen::Vector3d& m) const;
  };
  struct Mirror;

  int count_;
  std::array<Meeting, 2> meets_;
  Meeting again_;  ///< a pair's first mirror, met once more on the way out
};

}  // namespace raysteer::calib::bake
