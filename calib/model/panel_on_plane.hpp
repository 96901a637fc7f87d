// value: a projector posed against a plane, through whatever mirrors: panel pixel to place on the plane and back.
//
// An odd number of mirrors flips the picture. No proper rotation does that, so the panel's columns are counted from the
// other side first: x' = (width - 1) - x; `lens` belongs to x'.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"

namespace raysteer::calib::model {

struct PanelOnPlane {
  Camera lens;             ///< of the panel as counted above
  Pose T_projector_plane;  ///< the plane is z = 0 of its frame
  bool mirrored = false;

  /// Where panel pixel x (may be fractional, may lie outside the panel) lights the plane, metres. No value where the
  /// lens cannot be undone or the ray does not meet the plane in front of the projector.
  std::optional<Eigen::Vector2d> on_plane(const Eigen::Vector2d& x) const;
  /// The panel pixel that lights p. No value behind the projector.
  std::optional<Eigen::Vector2d> on_panel(const Eigen::Vector2d& p) const;
  /// Panel pixels as `lens` counts them, and back.
  Eigen::Vector2d counted(const Eigen::Vector2d& x) const;
};

/// The lens for panel columns counted from the other side: centre and first tangential coefficient change.
Camera flipped(const Camera& lens);

/// Where the ray of camera pixel q meets the plane z = 0, metres. No value as in on_plane().
std::optional<Eigen::Vector2d> on_plane(const Camera& camera, const Pose& T_camera_plane, const Eigen::Vector2d& q);

}  // namespace raysteer::calib::model
