// pure: how far off a piece of a picture may fall that is looked at from somewhere: on relief, or from an eye.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/assess/on_surface.hpp"
#include "calib/steer/room.hpp"

namespace raysteer::calib::assess {

/// A place that a piece of a picture is meant for.
struct MeantPlace {
  Eigen::Vector3d p_room;
  Eigen::Vector3d normal_room;  ///< unit, of the surface there
  Eigen::Vector3d sight_room;   ///< unit, the way it is looked at: only what is off across it shows
  /// The place was measured by the rig's own eyes, with this uncertainty along the left eye's ray (m): then the
  /// cameras' errors move it as well. No value: known in the room.
  std::optional<double> scan_sigma_m;
};

/// error_95_mm is counted across the sight. A pixel's light, off as the calibration and the mirror's repeatability
/// leave it, falls on a surface that is nearer or farther than the scan says, and slides along itself:
///   e = (I - s s') [ -(along the surface) + d (n . surface's error) / (n . d) ],
/// d the light's way, n the surface's normal, s the sight; all of it linear in the calibration's numbers, whose joint
/// covariance is the rig's. No value behind the lens, or where an eye does not see the place.
std::optional<CornerBound> place_bound(const steer::InRoom& rig, const Eigen::Vector2d& command_rad,
                                       const MeantPlace& place, const steer::LookState& state = {});

}  // namespace raysteer::calib::assess
