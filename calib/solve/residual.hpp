// value: model minus measurement in px, with derivatives written by hand. Inside calib/solve and its tests.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "calib/model/rig.hpp"
#include "calib/solve/state.hpp"

namespace raysteer::calib::solve {

/// fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6
constexpr int kIntrinsics = 12;
using ByIntrinsics = Eigen::Matrix<double, 2, kIntrinsics>;
using ByPose = Eigen::Matrix<double, 2, 6>;  ///< left increment: rotation, translation
using BySag = Eigen::Matrix2d;

struct CornerDerivatives {
  ByIntrinsics by_intrinsics;
  ByPose by_device;  ///< T_device_rig
  ByPose by_view;    ///< T_rig_target
  BySag by_sag;
};

/// Residual of a corner; false when the point lies behind the device.
bool corner_residual(const TargetSpec& target, const CornerMeasurement& corner, const model::Camera& camera,
                     const model::Pose& T_device_rig, const model::Pose& T_rig_target, const Eigen::Vector2d& sag,
                     Eigen::Vector2d& residual, CornerDerivatives* derivatives);

struct PixelDerivatives {
  ByIntrinsics by_camera;
  ByPose by_camera_pose;
  ByIntrinsics by_projector;
  ByPose by_projector_pose;
  ByPose by_view;
  BySag by_sag;
};

/// Residual of a decoded pixel on the panel: the camera's ray meets the target's surface, and the projector sees that
/// point. False when the ray misses or the point lies behind the projector.
bool pixel_residual(const TargetSpec& target, const PixelMeasurement& pixel, const model::Camera& camera,
                    const model::Pose& T_camera_rig, const model::Camera& projector, const model::Pose& T_projector_rig,
                    const model::Pose& T_rig_target, const Eigen::Vector2d& sag, Eigen::Vector2d& residual,
                    PixelDerivatives* derivatives);

/// Intrinsics as one block, in the order above, and back.
std::array<double, kIntrinsics> intrinsics(const model::Camera& camera);
void set_intrinsics(model::Camera& camera, const double* block);

}  // namespace raysteer::calib::solve
