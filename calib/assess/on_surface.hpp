// pure: how far off light may fall, in millimetres on the surface: over the whole reach, and at a station's corners.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>
#include <vector>

#include "calib/steer/predict.hpp"
#include "calib/steer/room.hpp"

namespace raysteer::calib::assess {

/// The radius within which 95 % of two-dimensional normal errors lie: 2.45 sigma when both axes are equal, 1.96 when
/// one of them is nothing.
double radius_95(const Eigen::Matrix2d& covariance);

/// One command of the reach.
struct ReachCell {
  Eigen::Vector2d command_rad;
  Eigen::Vector3d p;        ///< where the picture's middle falls, metres, rig frame
  double middle_95_mm = 0;  ///< 95 % of errors there are below this, the mirror's repeatability included
  double worst_95_mm = 0;   ///< the same, worst of the middle and of corners that reach the surface
};

/// columns x rows commands over a box, row by row. No value where nothing reaches the surface.
struct ReachMap {
  int columns = 0;
  int rows = 0;
  std::vector<std::optional<ReachCell>> cells;
  double median_95_mm = 0;  ///< of worst_95_mm; NaN when nothing is reached
  double worst_95_mm = 0;
};

/// `surface`: a plane that stands for the scene. `least_rad`, `most_rad`: the commands to look at, usually the plan's
/// usable box or the limits.
ReachMap reach_map(const steer::Solution& solution, const steer::Surface& surface, const Eigen::Vector2d& least_rad,
                   const Eigen::Vector2d& most_rad, int columns = 25, int rows = 17);

struct CornerBound {
  Eigen::Vector2d x;       ///< panel px that should light it
  double error_95_mm = 0;  ///< 95 % upper bound of how far off it will be lit, along the surface
};

/// A station's corners at its command, in the room. `state`: after the loop was closed there; without it the mirror's
/// repeatability is part of the bound. No value where a corner is behind the lens.
std::optional<std::vector<CornerBound>> corner_bounds(const steer::InRoom& rig, const Eigen::Vector2d& command_rad,
                                                      std::span<const Eigen::Vector3d> corners_room,
                                                      const Eigen::Vector3d& normal_room,
                                                      const steer::LookState& state = {});

}  // namespace raysteer::calib::assess
