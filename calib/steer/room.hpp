// The solved rig in the room: datums at known places say where it stands, and correct what it is off by in common.
//
// A rigid fit of what the cameras measure would leave the cameras' own errors in every absolute position: 1 mm at 3 m
// for a focal length off by 0.03 %. Datums at known places see these errors. So pose and cameras are adjusted together,
// with the solution's covariance as prior; what the cameras turn out to be off by moves projector and mirror with them,
// as their covariance says (a Kalman step, exact to first order).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <span>

#include "calib/steer/predict.hpp"

namespace raysteer::calib::steer {

/// A place known in the room that both eyes saw.
struct RoomPoint {
  Eigen::Vector3d p_room;            ///< metres
  Eigen::Matrix3d covariance;        ///< of the survey, m^2; zero where it counts as exact
  std::array<Eigen::Vector2d, 2> q;  ///< camera px: left, right
  std::array<Eigen::Matrix2d, 2> cov_q;
};

struct InRoom {
  Solution solution;  ///< corrected; its looks' residuals are still those of the solve
  model::Pose T_rig_room;
  /// Of all the solution's parameters and, last, T_rig_room's left increment (6).
  Eigen::MatrixXd covariance;
  double whitened_rms = 0;  ///< of the points' pixels, per degree of freedom
};

/// `start`: T_rig_room about right, as a rigid fit gives it. Errors: kDatumsMissing (fewer than 4 points), kNotFinite,
/// kRigNotSolved (a point behind an eye, or places that fix no pose).
Result<InRoom> tie_to_room(const Solution& solution, std::span<const RoomPoint> points, const model::Pose& start);

/// predict() of a place in the room; `normal_room`: of the surface there.
std::optional<PanelPrediction> predict_in_room(const InRoom& rig, const Eigen::Vector2d& command_rad,
                                               const Eigen::Vector3d& p_room, const Eigen::Vector3d& normal_room,
                                               const LookState& state = {});

}  // namespace raysteer::calib::steer
