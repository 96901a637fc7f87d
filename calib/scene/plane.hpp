// Fits planes to points, robustly, and judges flatness in small patches.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <span>
#include <vector>

#include "calib/scene/triangulate.hpp"

namespace raysteer::calib::scene {

/// normal . p = distance; the normal points to the left view.
struct Plane {
  Eigen::Vector3d normal{0, 0, -1};
  double distance_m = 0;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< of two tilts (rad) and the distance at the centroid (m)
  Eigen::Vector3d centroid{0, 0, 0};
  double rms_m = 0;  ///< inliers to the plane
  std::size_t inliers = 0;
};

/// The plane most points lie on, within `band_m`. Deterministic. Errors: kTooFewMatches.
Result<Plane> dominant_plane(std::span<const CloudPoint> points, double band_m);

struct Flatness {
  double patch_rms_m = 0;      ///< median over patches of the RMS to the patch's own plane
  double predicted_rms_m = 0;  ///< the same from the points' covariances
  std::size_t patches = 0;
};

/// Flatness within square patches of `patch_m` on the dominant plane. Errors: kTooFewMatches.
Result<Flatness> flatness(std::span<const CloudPoint> points, const Plane& wall, double patch_m = 0.010);

}  // namespace raysteer::calib::scene
