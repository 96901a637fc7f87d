#include "calib/steer/room.hpp"

#include <string>

#include "calib/steer/eye_points.hpp"
#include "calib/steer/room_derivatives.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr std::size_t kFewest = 4;
constexpr int kIterations = 8;

/// One point's four residuals and what they depend on.
struct Row {
  Eigen::Vector4d residual;
  Eigen::Matrix<double, 4, Eigen::Dynamic> by_cameras;
  Eigen::Matrix<double, 4, 6> by_pose;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
};

std::optional<Row> row_of(const model::Rig& cameras, const model::Pose& T_rig_room, const RoomPoint& point) {
  Row row;
  const int n = cameras.offset(1) + cameras.count(1);
  row.by_cameras = Eigen::Matrix<double, 4, Eigen::Dynamic>::Zero(4, n);
  const Eigen::Vector3d p = T_rig_room * point.p_room;
  const Eigen::Matrix<double, 3, 6> p_by_pose = by_increment(T_rig_room.q * point.p_room);
  Eigen::Matrix<double, 4, 3> by_p;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const model::Device& device = cameras.devices[eye];
    const Eigen::Vector3d seen = device.T_device_rig * p;
    Eigen::Matrix<double, 2, 3> by_seen;
    const auto q = device.camera.project(seen, by_seen);
    if (!q) {
      return std::nullopt;
    }
    const auto at = static_cast<Eigen::Index>(2 * eye);
    const int lens = 4 + model::coefficients(device.camera.lens);
    const int first = cameras.offset(eye);
    row.residual.segment<2>(at) = *q - point.q[eye];
    row.by_cameras.block(at, first, 2, lens) = model::by_lens(device.camera, seen.head<2>() / seen.z());
    if (eye > 0) {
      row.by_cameras.block<2, 6>(at, first + lens) = by_seen * by_increment(device.T_device_rig.q * p);
    }
    by_p.middleRows<2>(at) = by_seen * device.T_device_rig.rotation();
    row.covariance.block<2, 2>(at, at) = point.cov_q[eye];
  }
  row.by_pose = by_p * p_by_pose;
  const Eigen::Matrix<double, 4, 3> by_room = by_p * T_rig_room.rotation();
  row.covariance += by_room * point.covariance * by_room.transpose();
  return row;
}

bool finite(const RoomPoint& point) {
  bool all = point.p_room.allFinite() && point.covariance.allFinite();
  for (std::size_t eye = 0; eye < 2; ++eye) {
    all = all && point.q[eye].allFinite() && point.cov_q[eye].allFinite();
  }
  return all;
}

}  // namespace

Result<InRoom> tie_to_room(const Solution& solution, std::span<const RoomPoint> points, const model::Pose& start) {
  if (points.size() < kFewest) {
    return fail(RCode::kDatumsMissing,
                "expected at least 4 datums that both cameras see, got " + std::to_string(points.size()));
  }
  for (const RoomPoint& point : points) {
    if (!finite(point)) {
      return fail(RCode::kNotFinite, "a datum's place, pixel or covariance is not a finite number");
    }
  }
  // The cameras' covariance after the solve, as unit normal numbers z.
  const Eigen::MatrixXd by_z = camera_prior(solution.cameras);
  const Eigen::Index m = by_z.cols();
  Eigen::VectorXd z = Eigen::VectorXd::Zero(m);
  InRoom rig{.solution = solution, .T_rig_room = start, .covariance = {}};
  Eigen::MatrixXd H;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    H = Eigen::MatrixXd::Zero(m + 6, m + 6);
    H.topLeftCorner(m, m).setIdentity();
    Eigen::VectorXd g = Eigen::VectorXd::Zero(m + 6);
    g.head(m) = z;
    double chi_square = z.squaredNorm();
    const model::Rig cameras = moved_cameras(solution.cameras, by_z * z);
    for (const RoomPoint& point : points) {
      const auto row = row_of(cameras, rig.T_rig_room, point);
      const Eigen::LLT<Eigen::Matrix4d> whiten(row ? row->covariance : Eigen::Matrix4d::Zero());
      if (!row || whiten.info() != Eigen::Success) {
        return fail(RCode::kRigNotSolved,
                    "a datum is behind a camera or its pixel has no covariance; expected "
                    "datums that both cameras saw, and a pose to start from");
      }
      Eigen::Matrix<double, 4, Eigen::Dynamic> J(4, m + 6);
      J << row->by_cameras * by_z, row->by_pose;
      J = whiten.matrixL().solve(J);
      const Eigen::Vector4d r = whiten.matrixL().solve(row->residual);
      H += J.transpose() * J;
      g += J.transpose() * r;
      chi_square += r.squaredNorm();
    }
    rig.whitened_rms = std::sqrt(chi_square / static_cast<double>(4 * points.size() - 6));
    const Eigen::VectorXd step = H.ldlt().solve(-g);
    if (!step.allFinite()) {
      return fail(RCode::kRigNotSolved, "the datums fix no pose; expected at least four that do not stand in a line");
    }
    z += step.head(m);
    rig.T_rig_room = model::moved_by(rig.T_rig_room, step.tail<6>());
  }
  const Eigen::MatrixXd after = H.inverse();
  if (!after.allFinite() || !(after.diagonal().minCoeff() > 0)) {
    return fail(RCode::kRigNotSolved, "the datums fix no pose; expected at least four that do not stand in a line");
  }

  // What all other numbers do when z moves: cov(all, z), since z has unit covariance.
  const int n_c = solution.camera_parameters();
  const int n_p = solution.projector_parameters();
  const Eigen::Index n = solution.covariance.rows();
  // Scaled to correlations, where by_z's columns stand upright on each other.
  const Eigen::VectorXd sigma = solution.cameras.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = (sigma.array() > 0).select(1 / sigma.array().max(1e-300), 0);
  const Eigen::MatrixXd scaled = inverse.asDiagonal() * by_z;
  const Eigen::VectorXd lengths = scaled.colwise().squaredNorm();
  const Eigen::MatrixXd by =
      solution.covariance.leftCols(n_c) * inverse.asDiagonal() * scaled * lengths.cwiseInverse().asDiagonal();
  const Eigen::VectorXd moved = by * z;
  rig.solution.cameras = moved_cameras(solution.cameras, moved.head(n_c));
  rig.solution.projector = model::perturbed(solution.projector, moved.segment(n_c, n_p));
  for (std::size_t k = 0; k < rig.solution.looks.size(); ++k) {
    const auto at = n_c + n_p + static_cast<Eigen::Index>(2 * k);
    if (at + 2 <= n) {
      rig.solution.looks[k].latent_rad += moved.segment<2>(at);
    }
  }
  rig.covariance.resize(n + 6, n + 6);
  rig.covariance.topLeftCorner(n, n) =
      solution.covariance + by * (after.topLeftCorner(m, m) - Eigen::MatrixXd::Identity(m, m)) * by.transpose();
  rig.covariance.topRightCorner(n, 6) = by * after.topRightCorner(m, 6);
  rig.covariance.bottomLeftCorner(6, n) = rig.covariance.topRightCorner(n, 6).transpose();
  rig.covariance.bottomRightCorner<6, 6>() = after.bottomRightCorner<6, 6>();
  rig.solution.covariance = rig.covariance.topLeftCorner(n, n);
  rig.solution.cameras.covariance = rig.covariance.topLeftCorner(n_c, n_c);
  return rig;
}

Eigen::Matrix<double, 3, 6> by_increment(const Eigen::Vector3d& turned) {
  Eigen::Matrix<double, 3, 6> by;
  by << -model::cross_matrix(turned), Eigen::Matrix3d::Identity();
  return by;
}

std::optional<LightOnPlace> light_on_place(const InRoom& rig, const Eigen::Vector2d& command_rad,
                                           const Eigen::Vector3d& p_room, const LookState& state) {
  const model::SteeredLook look(rig.solution.projector, command_rad, state.latent_rad);
  model::PixelDerivatives by;
  const auto x = look.project(rig.T_rig_room * p_room, by);
  if (!x) {
    return std::nullopt;
  }
  const int n_c = rig.solution.camera_parameters();
  const int n_p = rig.solution.projector_parameters();
  LightOnPlace light{.x = *x, .by_point = by.by_point, .by_numbers = {}, .by_angles = by.by_angles};
  light.by_numbers = Eigen::Matrix<double, 2, Eigen::Dynamic>::Zero(2, rig.covariance.cols());
  light.by_numbers.middleCols(n_c, n_p) = by.by_parameters;
  if (state.by_parameters.cols() == n_c + n_p) {
    light.by_numbers.leftCols(n_c + n_p) += by.by_angles * state.by_parameters;
  }
  light.by_numbers.rightCols<6>() = by.by_point * by_increment(rig.T_rig_room.q * p_room);
  return light;
}

std::optional<PanelPrediction> predict_in_room(const InRoom& rig, const Eigen::Vector2d& command_rad,
                                               const Eigen::Vector3d& p_room, const Eigen::Vector3d& normal_room,
                                               const LookState& state) {
  const auto light = light_on_place(rig, command_rad, p_room, state);
  if (!light) {
    return std::nullopt;
  }
  const Eigen::Matrix2d angles = state.covariance_rad2.value_or(
      rig.solution.repeatability_rad * rig.solution.repeatability_rad * Eigen::Matrix2d::Identity());
  PanelPrediction prediction{.x = light->x, .covariance = {}, .mm_per_px = {}};
  prediction.covariance = light->by_numbers * rig.covariance * light->by_numbers.transpose() +
                          light->by_angles * angles * light->by_angles.transpose();
  const Eigen::Matrix2d px_per_m = light->by_point * model::tangents(rig.T_rig_room.q * normal_room);
  prediction.mm_per_px = 1e3 * px_per_m.inverse();
  return prediction;
}

}  // namespace raysteer::calib::steer
