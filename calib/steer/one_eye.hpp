// pure: light that one eye saw on a known plane, as if the other eye had seen it too: the plane stands in for it.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"
#include "calib/steer/observations.hpp"

namespace raysteer::calib::steer {

/// z = 0 of its frame; a board lay on it, for example.
struct KnownPlane {
  model::Pose T_rig_plane;
  Eigen::Matrix<double, 6, 6> covariance;  ///< of T_rig_plane's left increment: rotation, translation
};

/// A mirror that seems to repeat this many times worse than drawn stands in for a plane that is not where it is said.
inline constexpr double kMostScatter = 2.5;

/// How far off along its normal the plane may be at p, m^2.
double variance_along_normal(const KnownPlane& plane, const Eigen::Vector3d& p);

/// Eye `eye` (0: left) saw panel pixel x (known exactly) at q. The other eye's pixel is where it would see the ray meet
/// the plane; its covariance is the plane's along the epipolar line and says nothing across it, so that a solve takes
/// exactly what was known: the point lies on the ray and on the plane.
///
/// What the plane is off by is common to all points on it, while a solve counts each point's error as its own. So it is
/// stated `together` times as large in variance: all `together` points of the plane then know it no better than one.
///
/// No value where the ray does not meet the plane in front of both eyes, or at less than six degrees.
std::optional<LitPoint> seen_on_plane(const model::Rig& cameras, const KnownPlane& plane, std::size_t eye,
                                      const Eigen::Vector2d& x, const Eigen::Vector2d& q, const Eigen::Matrix2d& cov_q,
                                      std::size_t together);

}  // namespace raysteer::calib::steer
