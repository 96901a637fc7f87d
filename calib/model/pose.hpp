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

}  // namespace raysteer::calib::model
