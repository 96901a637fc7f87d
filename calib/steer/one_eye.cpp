#include "calib/steer/one_eye.hpp"

#include <cmath>

namespace raysteer::calib::steer {
namespace {

constexpr double kLeastSine = 0.1;      // of a ray to the plane
constexpr double kAcrossPx = 1e3;       // says nothing
constexpr double kLeastAlongPx = 0.02;  // no stand-in is surer than a pixel's own floor

}  // namespace

double variance_along_normal(const KnownPlane& plane, const Eigen::Vector3d& p) {
  // exp([w]) R x + t + d moves a point p of the plane by w x (p - t) + d.
  const Eigen::Vector3d normal = plane.T_rig_plane.q * Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 6, 1> by;
  by << (p - plane.T_rig_plane.t).cross(normal), normal;
  return by.dot(plane.covariance * by);
}

std::optional<LitPoint> seen_on_plane(const model::Rig& cameras, const KnownPlane& plane, std::size_t eye,
                                      const Eigen::Vector2d& x, const Eigen::Vector2d& q, const Eigen::Matrix2d& cov_q,
                                      std::size_t together) {
  const model::Device& sees = cameras.devices[eye];
  const model::Device& other = cameras.devices[1 - eye];
  const auto n = sees.camera.normalize(q);
  if (!n) {
    return std::nullopt;
  }
  const model::Pose back = sees.T_device_rig.inverse();
  const Eigen::Vector3d along = back.q * n->homogeneous().normalized();
  const Eigen::Vector3d normal = plane.T_rig_plane.q * Eigen::Vector3d::UnitZ();
  const double sine = normal.dot(along);
  const double length = normal.dot(plane.T_rig_plane.t - back.t) / sine;
  if (!(std::abs(sine) > kLeastSine) || !(length > 0)) {
    return std::nullopt;
  }
  const Eigen::Vector3d p = back.t + length * along;
  Eigen::Matrix<double, 2, 3> by_point;
  const auto stand_in = other.camera.project(other.T_device_rig * p, by_point);
  if (!stand_in) {
    return std::nullopt;
  }
  // How the stand-in moves along its epipolar line with the plane along its normal.
  const Eigen::Vector2d by_length = by_point * (other.T_device_rig.q * along);
  const double px_per_m = by_length.norm();
  if (!(px_per_m > 0)) {
    return std::nullopt;
  }
  const Eigen::Vector2d u = by_length / px_per_m;
  const Eigen::Vector2d v(-u.y(), u.x());
  const double common = variance_along_normal(plane, p) / (sine * sine) * px_per_m * px_per_m;
  LitPoint point{.x = x, .q = {}, .cov_x = Eigen::Matrix2d::Zero(), .cov_q = {}};
  point.q[eye] = q;
  point.cov_q[eye] = cov_q;
  point.q[1 - eye] = *stand_in;
  point.cov_q[1 - eye] = (kLeastAlongPx * kLeastAlongPx + static_cast<double>(together) * common) * u * u.transpose() +
                         kAcrossPx * kAcrossPx * v * v.transpose();
  return point;
}

}  // namespace raysteer::calib::steer
