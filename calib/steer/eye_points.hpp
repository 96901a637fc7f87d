// value: surface points as both eyes see them, with what the cameras' own errors do to them.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/steer/observations.hpp"

namespace raysteer::calib::steer {

/// The cameras' covariance as unit normal numbers z: parameters = calibrated + by_z * z. Parameters held fixed have no
/// part in z, so a singular covariance needs no care elsewhere.
Eigen::MatrixXd camera_prior(const model::Rig& cameras);

/// `cameras` with all parameters moved by `delta` (order of model::Rig).
model::Rig moved_cameras(const model::Rig& cameras, const Eigen::VectorXd& delta);

/// A point triangulated with the cameras as they are held, everything linear in z about there.
struct EyePoint {
  Eigen::Vector2d x;      ///< panel px
  Eigen::Matrix2d cov_x;  ///< px^2
  Eigen::Vector3d p;      ///< metres, rig frame
  Eigen::Matrix3d covariance;
  double between_eyes = 0;  ///< by how much the rays miss each other, whitened: one residual
  Eigen::Matrix<double, 3, Eigen::Dynamic> p_by_z;
  Eigen::RowVectorXd between_by_z;
  Eigen::Matrix<double, 3, 6> p_by_right = Eigen::Matrix<double, 3, 6>::Zero();  ///< pose of the right camera
  Eigen::Matrix<double, 1, 6> between_by_right = Eigen::Matrix<double, 1, 6>::Zero();
};

/// Two eyes of a rig.
class Eyes {
 public:
  Eyes(const model::Rig& cameras, const Eigen::MatrixXd& by_z) : cameras_(cameras), by_z_(by_z) {}
  /// No value where the rays are parallel, meet behind an eye, or a pixel has no ray.
  std::optional<EyePoint> see(const LitPoint& point) const;

 private:
  const model::Rig& cameras_;
  const Eigen::MatrixXd& by_z_;
};

}  // namespace raysteer::calib::steer
