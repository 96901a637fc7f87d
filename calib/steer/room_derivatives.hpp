// pure: what the light on a place in the room depends on.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/steer/room.hpp"

namespace raysteer::calib::steer {

/// d(p_to)/d(left increment) of T p, at T p without its translation.
Eigen::Matrix<double, 3, 6> by_increment(const Eigen::Vector3d& turned);

/// The panel pixel that lights a place in the room.
struct LightOnPlace {
  Eigen::Vector2d x;                                    ///< panel px
  Eigen::Matrix<double, 2, 3> by_point;                 ///< px per metre, rig frame
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_numbers;  ///< px per unit of each number that InRoom::covariance has
  Eigen::Matrix2d by_angles;                            ///< px per rad of the mirror's angles
};

/// No value behind the lens.
std::optional<LightOnPlace> light_on_place(const InRoom& rig, const Eigen::Vector2d& command_rad,
                                           const Eigen::Vector3d& p_room, const LookState& state = {});

}  // namespace raysteer::calib::steer
