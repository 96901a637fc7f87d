// value: a steered projector at one look, with derivatives of every pixel by everything that may vary.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>

#include "calib/model/steered_parameters.hpp"
#include "calib/model/steered_projector.hpp"

namespace raysteer::calib::model {

/// 2 x parameters, on the stack.
using ByParameters = Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, kMostSteeredParameters>;

struct PixelDerivatives {
  Eigen::Matrix<double, 2, 3> by_point;  ///< px/m, rig frame
  ByParameters by_parameters;            ///< order of steered_parameters.hpp
  Eigen::Matrix2d by_angles;             ///< px/rad, mechanical angles of axis 1, 2
};

/// A pixel by fx fy cx cy and the coefficients of the camera's lens model, at undistorted coordinates n.
Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12> by_lens(const Camera& camera,
                                                                         const Eigen::Vector2d& n);

/// The matrix of v x.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v);

class SteeredLook {
 public:
  /// `latent_rad` is added to the angles that the curve gives (algorithms 4.5).
  SteeredLook(const SteeredProjector& projector, const Eigen::Vector2d& command_rad,
              const Eigen::Vector2d& latent_rad = Eigen::Vector2d::Zero());

  const VirtualProjector& view() const { return view_; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_rig) const { return view_.project(p_rig); }
  /// The same with derivatives. No value behind the lens.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_rig, PixelDerivatives& by) const;

 private:
  /// The plane normal.X = distance, and both by the mirror's parameters (up to 14) and, last, the two angles.
  struct Plane {
    Eigen::Vector3d normal;
    double distance = 0;
    Eigen::Matrix<double, 3, 16> normal_by = Eigen::Matrix<double, 3, 16>::Zero();
    Eigen::Matrix<double, 1, 16> distance_by = Eigen::Matrix<double, 1, 16>::Zero();
  };
  static Plane turned(const MirrorPart& part, double angle, int first, int point_first, int normal_first, int offset_at,
                      int angle_at);
  static Plane carried(const Plane& plane, const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double angle);

  MirrorKind kind_;
  Pose T_projector_rig_;
  Eigen::Matrix3d R_projector_rig_;
  VirtualProjector view_;
  std::array<Plane, 2> planes_;  ///< in the order that scene points are reflected; a head has one
  int plane_count_;
  Eigen::Matrix<double, 2, kCurveParameters> angles_by_curves_ = Eigen::Matrix<double, 2, kCurveParameters>::Zero();
};

}  // namespace raysteer::calib::model
