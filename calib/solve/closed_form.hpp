// Start values without a guess: what linear algebra says about cameras and projectors. Inside calib/solve and its
// tests.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <span>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"

namespace raysteer::calib::solve {

/// H with (u, v, 1) ~ H (x, y, 1), from at least four points; normalised direct linear transform (Hartley).
std::optional<Eigen::Matrix3d> homography(std::span<const Eigen::Vector2d> on_plane,
                                          std::span<const Eigen::Vector2d> on_image);

/// Focal length for square pixels and a known principal point from homographies of planes (Zhang's two constraints a
/// view, linear in 1/f^2). No value when the planes leave it open.
std::optional<double> focal_length(std::span<const Eigen::Matrix3d> homographies, const Eigen::Vector2d& centre);

/// Pose of the plane before an undistorted pinhole.
model::Pose plane_pose(const Eigen::Matrix3d& homography, double focal, const Eigen::Vector2d& centre);

/// A pinhole and its pose from points in space, no lens, by the direct linear transform; needs at least six points that
/// do not lie in one plane. The principal point may be anywhere.
struct Resection {
  double fx = 0, fy = 0, cx = 0, cy = 0;
  model::Pose T_device_world;
  bool mirrored = false;  ///< fits only a device that flips its image
};
std::optional<Resection> resection(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector2d> pixels);

/// Rotation and translation that are the median of many, number by number on a common tangent plane.
model::Pose median_pose(std::span<const model::Pose> poses);

}  // namespace raysteer::calib::solve
