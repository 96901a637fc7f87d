// The plane that a board lies on, as one calibrated eye or several see it.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>

#include "calib/look/solve_look.hpp"

namespace raysteer::calib::look {

struct BoardPlane {
  model::Pose T_rig_plane;                 ///< the board's frame: z = 0 is the plane
  Eigen::Matrix<double, 6, 6> covariance;  ///< of its left increment, the cameras taken as exact; raised to what was
                                           ///< seen where corners fit worse than stated
  double rms_px = 0;                       ///< per coordinate
  int corners = 0;
};

/// From the board in one eye, in closed form; no value with fewer than 6 corners.
std::optional<model::Pose> plane_start(const TargetSpec& target, const Sight& sight);

/// Only the sights' corners are used. Errors: kTooFewCorrespondences (no eye sees 6 corners), kLookNotSolved (corners
/// miss the common plane by more than half a pixel: the board is bent, not the one stated, or the cameras moved).
Result<BoardPlane> board_plane(const TargetSpec& target, std::span<const Sight> sights);

}  // namespace raysteer::calib::look
