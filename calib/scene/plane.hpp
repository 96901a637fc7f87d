// Fits planes to points, robustly, and judges flatness in small patches.
#pragma once

#include <Eigen/Dense>
#include <span>

#include "calib/scene/triangulate.hpp"

namespace raysteer::calib::scene {

/// normal . p = distance_m; the normal points towards the left view.
struct Plane {
  Eigen::Vector3d normal{0, 0, -1};
  double distance_m = 0;
  Eigen::Vector3d centroid{0, 0, 0};
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  ///< columns: two directions in the plane, then the normal
  /// Of the tilts about the two directions (rad) and of the distance at the centroid (m). From the scatter of the
  /// inliers, which counts every point as independent.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  double rms_m = 0;         ///< inliers to the plane
  std::size_t inliers = 0;  ///< points within `band_m`

  double signed_distance(const Eigen::Vector3d& p) const { return normal.dot(p) - distance_m; }
};

/// The plane that most points lie on, within `band_m`. Samples are drawn in a fixed order: the same points give the
/// same plane. Errors: kTooFewMatches (fewer than 100 points, or all on a line).
Result<Plane> dominant_plane(std::span<const CloudPoint> points, double band_m);

/// Flatness within square patches on a wall.
struct Flatness {
  double patch_rms_m = 0;      ///< median over patches of the RMS distance to the patch's own plane
  double predicted_rms_m = 0;  ///< median over patches of what the points' covariances say it should be
  double trimmed = 0;          ///< share of the patches' points left out as gross
  std::size_t patches = 0;
};

struct FlatnessOptions {
  double patch_m = 0.010;  ///< side of a patch
  double band_m = 0.015;   ///< points this close to the wall's plane belong to the wall
};

/// The rule: patches are the squares of a grid on the wall's plane that hold at least 50 points and at least half of
/// the median number of such squares; in each a least-squares plane, points beyond 4 robust sigma left out once, the
/// plane again; RMS with 3 degrees of freedom taken off. Errors: kTooFewMatches (fewer than 10 patches).
Result<Flatness> flatness(std::span<const CloudPoint> points, const Plane& wall, const FlatnessOptions& options = {});

}  // namespace raysteer::calib::scene
