// pure: do two views show one plane (or one place of looking), or depth? Torr's geometric robust information criterion.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>

namespace raysteer::calib::steer {

/// One place in two views, undistorted normalised coordinates (X/Z, Y/Z); covariances in the same unit.
struct ViewPair {
  Eigen::Vector2d a, b;
  Eigen::Matrix2d cov_a, cov_b;
};

/// GRIC = sum min(e^2, 20 (r - d)) + n d ln r + k ln(r n), e whitened, r = 4 coordinates; a homography has d = 2, k =
/// 8, a fundamental matrix d = 3, k = 7; the smaller one explains better (Torr, Int. J. Comput. Vision 50(1), 2002). In
/// a plane the difference is -0.386 n + ln(4 n). Torr bounds e^2 by 2 (r - d), which takes a third of all points off
/// the plane for outliers; here few are left, and a box in a corner is depth: one point in thirty is enough.
struct Gric {
  double plane = 0;
  double depth = 0;
  std::size_t points = 0;
  bool flat() const { return plane <= depth; }
};

/// How well the views' lenses are known. Open ones: the homography may bend both views by radial and tangential terms
/// (k = 16), since over a plane lenses come out of a solve as wrong as focal lengths do, and what a wrong lens leaves
/// would pass for depth.
enum class Lenses { kKnown, kOpen };

/// `F`: about right, b~^T F a~ = 0. Both models are fitted robustly first. Fewer than 8 pairs count as flat.
Gric plane_or_depth(std::span<const ViewPair> pairs, const Eigen::Matrix3d& F, Lenses lenses = Lenses::kKnown);

/// b~^T F a~ = 0 for a point p seen as p and as R p + t.
Eigen::Matrix3d fundamental(const Eigen::Matrix3d& R, const Eigen::Vector3d& t);

}  // namespace raysteer::calib::steer
