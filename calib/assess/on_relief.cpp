#include "calib/assess/on_relief.hpp"

#include <cmath>

#include "calib/steer/eye_points.hpp"
#include "calib/steer/room_derivatives.hpp"

namespace raysteer::calib::assess {
namespace {

/// 3 x all numbers: how a place that both eyes see moves, in the room, with the calibration's numbers.
std::optional<Eigen::Matrix<double, 3, Eigen::Dynamic>> seen_place_by_numbers(const steer::InRoom& rig,
                                                                              const Eigen::Vector3d& p_room) {
  const model::Rig& cameras = rig.solution.cameras;
  steer::LitPoint point{.x = Eigen::Vector2d::Zero(), .q = {}, .cov_x = Eigen::Matrix2d::Zero(), .cov_q = {}};
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto q = cameras.devices[eye].camera.project(cameras.devices[eye].T_device_rig * (rig.T_rig_room * p_room));
    if (!q) {
      return std::nullopt;
    }
    point.q[eye] = *q;
    point.cov_q[eye] = Eigen::Matrix2d::Identity();
  }
  const int n_c = rig.solution.camera_parameters();
  const Eigen::MatrixXd every_number = Eigen::MatrixXd::Identity(n_c, n_c);
  const auto seen = steer::Eyes(cameras, every_number).see(point);
  if (!seen) {
    return std::nullopt;
  }
  const Eigen::Matrix3d R_room_rig = rig.T_rig_room.rotation().transpose();
  Eigen::Matrix<double, 3, Eigen::Dynamic> by =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, rig.covariance.cols());
  by.leftCols(n_c) = R_room_rig * seen->p_by_z;
  by.rightCols<6>() = -R_room_rig * steer::by_increment(rig.T_rig_room.q * p_room);
  return by;
}

}  // namespace

std::optional<CornerBound> place_bound(const steer::InRoom& rig, const Eigen::Vector2d& command_rad,
                                       const MeantPlace& place, const steer::LookState& state) {
  const auto light = steer::light_on_place(rig, command_rad, place.p_room, state);
  if (!light) {
    return std::nullopt;
  }
  const Eigen::Matrix3d R_room_rig = rig.T_rig_room.rotation().transpose();
  // Metres along the surface that a pixel's light moves by per px, in the room.
  const Eigen::Matrix<double, 3, 2> along = model::tangents(rig.T_rig_room.q * place.normal_room);
  const Eigen::Matrix2d px_per_m = light->by_point * along;
  const Eigen::Matrix<double, 3, 2> by_px = R_room_rig * along * px_per_m.inverse();
  Eigen::Matrix<double, 3, Eigen::Dynamic> by_numbers = -by_px * light->by_numbers;

  const Eigen::Vector3d from = rig.solution.projector.at(command_rad).centre();
  const Eigen::Vector3d way = (R_room_rig * (rig.T_rig_room * place.p_room - from)).normalized();
  // Metres that the light slides per metre that the surface lies before its place, along its normal.
  const Eigen::Vector3d slide = way / place.normal_room.dot(way);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  if (place.scan_sigma_m) {
    const auto by_cameras = seen_place_by_numbers(rig, place.p_room);
    if (!by_cameras) {
      return std::nullopt;
    }
    by_numbers += slide * (place.normal_room.transpose() * *by_cameras);
    const Eigen::Vector3d ray = (R_room_rig * (rig.T_rig_room * place.p_room)).normalized();
    const Eigen::Vector3d by_scan = *place.scan_sigma_m * place.normal_room.dot(ray) * slide;
    covariance += by_scan * by_scan.transpose();
  }
  const Eigen::Matrix2d angles = state.covariance_rad2.value_or(
      rig.solution.repeatability_rad * rig.solution.repeatability_rad * Eigen::Matrix2d::Identity());
  const Eigen::Matrix<double, 3, 2> by_angles = by_px * light->by_angles;
  covariance += by_numbers * rig.covariance * by_numbers.transpose() + by_angles * angles * by_angles.transpose();
  if (!covariance.allFinite()) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 3, 2> across = model::tangents(place.sight_room);
  return CornerBound{.x = light->x, .error_95_mm = 1e3 * radius_95(across.transpose() * covariance * across)};
}

}  // namespace raysteer::calib::assess
