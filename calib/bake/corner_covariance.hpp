// pure: how far the corners of a baked rectangle may lie off, by the covariance of the look.
#pragma once

#include <Eigen/Dense>

#include "calib/look/solve_look.hpp"

namespace raysteer::calib::bake {

/// Of the four corners (x, y of each in the plane, metres) of level_rectangle(T_rig_plane, offset, width, height) as
/// `solution` puts them on the panel, against the same rectangle on the true plane. `covariance` is the solution's, or
/// with_cameras().
Eigen::Matrix<double, 8, 8> corner_covariance(const look::Solution& solution, const look::Covariance& covariance,
                                              const Eigen::Vector2d& offset_m, double width_m, double height_m);

}  // namespace raysteer::calib::bake
