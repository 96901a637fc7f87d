// value: what a pretend rig truly is. Frames: rig = left camera, x right, y down, z forward; metres.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>

#include "hal/base/result.hpp"
#include "proto/board/board.hpp"
#include "sim/optics/lens.hpp"
#include "sim/optics/mirror.hpp"

namespace raysteer::sim::optics {

struct TrueCamera {
  std::string name;
  int width = 0;
  int height = 0;
  Lens lens;
  Eigen::Isometry3d T_camera_rig = Eigen::Isometry3d::Identity();
  double f_number = 4;
  double pixel_m = 3.45e-6;
  double quantum_efficiency = 0.6;
  double blur_px = 0.5;  ///< standard deviation of the lens's point spread

  /// Direction of a pixel in the rig frame, unit; from centre().
  Eigen::Vector3d ray(const Eigen::Vector2d& q) const { return T_camera_rig.linear().transpose() * lens.ray(q); }
  Eigen::Vector3d centre() const { return -(T_camera_rig.linear().transpose() * T_camera_rig.translation()); }
  /// Pixel of a rig-frame point, inside the picture or not; nothing behind the lens.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_rig) const {
    return lens.project(T_camera_rig * p_rig);
  }
};

struct TrueProjector {
  int width = 0;
  int height = 0;
  Lens lens;
  Eigen::Isometry3d T_projector_rig = Eigen::Isometry3d::Identity();
  double lumens = 0;    ///< white, whole panel, shared equally by its pixels
  double focus_m = 0;   ///< sharp at this distance along the light's way from the lens
  double pupil_m = 0;   ///< diameter of the exit pupil
  double fall_off = 4;  ///< picture's light falls as cos^fall_off of the angle off the optical axis
};

struct TrueRig {
  std::array<TrueCamera, 2> cameras;  ///< left, right; hal::Eye is the index
  TrueProjector projector;
  TrueMirror mirror;  ///< in the projector's frame
};

/// The rig exactly as its board draws it, without a workshop's errors (sim/rig/truth.hpp draws those).
/// kBadValue: two cameras are needed; a lens whose distortion folds inside its picture; axes or normals without length.
Result<TrueRig> rig_as_drawn(const proto::board::Board& board);

}  // namespace raysteer::sim::optics
