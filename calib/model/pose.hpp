// value: a rigid motion. T_a_b takes a point in b coordinates to a coordinates; neighbours cancel.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>

namespace raysteer::calib::model {

struct Pose {
  Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();  ///< metres

  Eigen::Vector3d operator*(const Eigen::Vector3d& p) const { return q * p + t; }
  Pose operator*(const Pose& other) const { return {(q * other.q).normalized(), q * other.t + t}; }
  Pose inverse() const { return {q.conjugate(), -(q.conjugate() * t)}; }
  Eigen::Matrix3d rotation() const { return q.toRotationMatrix(); }
};

/// exp([w]): the rotation by |w| radians about w.
inline Eigen::Quaterniond rotation_by(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  if (angle < 1e-12) {
    return Eigen::Quaterniond(1, w.x() / 2, w.y() / 2, w.z() / 2).normalized();
  }
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, w / angle));
}

/// `pose` with the left increment (rotation 3, radians: R = exp([w]) R0; translation 3, metres) that solvers use.
inline Pose moved_by(const Pose& pose, const Eigen::Matrix<double, 6, 1>& increment) {
  return {(rotation_by(increment.head<3>()) * pose.q).normalized(), pose.t + increment.tail<3>()};
}

}  // namespace raysteer::calib::model
