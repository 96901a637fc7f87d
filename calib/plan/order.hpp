// pure: in which order to visit looks.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

namespace raysteer::calib::plan {

/// The order (indices) in which as few looks as possible are approached from above on either axis, and among those
/// orders one with short travel: backlash then acts the same way at nearly every look. How the first one is approached
/// is left open. Lengths count in units of `span_rad` per axis.
std::vector<std::size_t> visiting_order(std::span<const Eigen::Vector2d> commands_rad, const Eigen::Vector2d& span_rad);

/// How many looks of a visit are approached from above on an axis, the first left out.
int approached_from_above(std::span<const Eigen::Vector2d> commands_rad);

}  // namespace raysteer::calib::plan
