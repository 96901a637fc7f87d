// pure: where a panel pixel landed in the room, measured by both eyes, and how sure that is.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>
#include <vector>

#include "calib/steer/observations.hpp"
#include "calib/steer/room.hpp"

namespace raysteer::host::rig {

/// A lit point that both eyes saw.
struct SeenPixel {
  Eigen::Vector2d x;       ///< panel px
  Eigen::Vector3d p_room;  ///< metres
  /// By the cameras' parameters and, last, the increment of the rig's pose in the room (6).
  Eigen::Matrix<double, 3, Eigen::Dynamic> by;
};

/// The look's points that can be triangulated, in their order.
std::vector<SeenPixel> seen_pixels(const calib::steer::InRoom& rig, const calib::steer::Look& look);

/// What cameras and tie together are off by, of a place with these derivatives, m^2.
Eigen::Matrix3d common_covariance(const calib::steer::InRoom& rig, const Eigen::Matrix<double, 3, Eigen::Dynamic>& by);

struct MeasuredPixel {
  Eigen::Vector3d p_room;      ///< metres
  Eigen::Matrix3d covariance;  ///< m^2: the points' noise, the cameras' errors and those of the tie to the room
};

inline constexpr std::size_t kFewestAround = 12;  ///< a quadratic has six numbers

/// Where pixel x landed: a quadratic through the points seen around it. Its noise is what the points miss the quadratic
/// by; cameras and tie move all points together, as the rig's covariance says. No value with fewer than 12 points, or
/// when they lie in a line.
std::optional<MeasuredPixel> measure_pixel(const calib::steer::InRoom& rig, const Eigen::Vector2d& x,
                                           std::span<const SeenPixel> seen);

}  // namespace raysteer::host::rig
