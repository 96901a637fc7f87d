#include "calib/steer/predict.hpp"

#include <array>

#include "calib/steer/eye_points.hpp"

namespace raysteer::calib::steer {
namespace {

/// What a point moves by when the cameras that measured it are off: its pixels stay, so it follows.
Eigen::Matrix<double, 3, Eigen::Dynamic> by_cameras(const Solution& solution, const Eigen::Vector3d& p) {
  const Eigen::Index n = solution.camera_parameters();
  const Eigen::MatrixXd as_they_are = Eigen::MatrixXd::Identity(n, n);
  LitPoint point{.x = {0, 0}, .q = {}, .cov_x = Eigen::Matrix2d::Zero(), .cov_q = {}};
  for (std::size_t i = 0; i < 2; ++i) {
    const model::Device& eye = solution.cameras.devices[i];
    const auto q = eye.camera.project(eye.T_device_rig * p);
    if (!q) {
      return Eigen::MatrixXd::Zero(3, n);  // no camera can have measured it
    }
    point.q[i] = *q;
    point.cov_q[i].setIdentity();
  }
  const auto seen = Eyes(solution.cameras, as_they_are).see(point);
  return seen ? seen->p_by_z : Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, n);
}

}  // namespace

Eigen::Matrix<double, 2, Eigen::Dynamic> prediction_by_parameters(const Solution& solution,
                                                                  const model::PixelDerivatives& by,
                                                                  const Eigen::Vector3d& p, PointFrom from) {
  const Eigen::Index n_c = solution.camera_parameters();
  Eigen::Matrix<double, 2, Eigen::Dynamic> all(2, n_c + solution.projector_parameters());
  if (from == PointFrom::kCameras) {
    all.leftCols(n_c) = by.by_point * by_cameras(solution, p);
  } else {
    all.leftCols(n_c).setZero();
  }
  all.rightCols(solution.projector_parameters()) = by.by_parameters;
  return all;
}

std::optional<Eigen::Matrix2d> PanelPrediction::covariance_mm2() const {
  if (!mm_per_px) {
    return std::nullopt;
  }
  return Eigen::Matrix2d(*mm_per_px * covariance * mm_per_px->transpose());
}

std::optional<PanelPrediction> predict(const Solution& solution, const Eigen::Vector2d& command_rad,
                                       const Eigen::Vector3d& p, PointFrom from, const std::optional<Surface>& surface,
                                       const LookState& state) {
  const model::SteeredLook look(solution.projector, command_rad, state.latent_rad);
  model::PixelDerivatives by;
  const auto x = look.project(p, by);
  if (!x) {
    return std::nullopt;
  }
  Eigen::Matrix<double, 2, Eigen::Dynamic> all = prediction_by_parameters(solution, by, p, from);
  const Eigen::Index n = all.cols();
  if (state.by_parameters.cols() == n) {
    all += by.by_angles * state.by_parameters;
  }
  const Eigen::Matrix2d angles = state.covariance_rad2.value_or(
      solution.repeatability_rad * solution.repeatability_rad * Eigen::Matrix2d::Identity());
  PanelPrediction prediction{.x = *x, .covariance = {}, .mm_per_px = {}};
  prediction.covariance = all * solution.covariance.topLeftCorner(n, n) * all.transpose() +
                          by.by_angles * angles * by.by_angles.transpose();
  if (surface) {
    const Eigen::Matrix2d px_per_m = by.by_point * model::tangents(surface->normal);
    prediction.mm_per_px = 1e3 * px_per_m.inverse();
  }
  return prediction;
}

std::optional<Landing> land(const Solution& solution, const Eigen::Vector2d& command_rad, const Eigen::Vector2d& x,
                            const Surface& surface, PointFrom from, const LookState& state) {
  const model::SteeredLook look(solution.projector, command_rad, state.latent_rad);
  const auto ray = look.view().ray(x);
  if (!ray) {
    return std::nullopt;
  }
  const Eigen::Vector3d centre = look.view().centre();
  const double distance = surface.normal.dot(surface.point - centre) / surface.normal.dot(*ray);
  if (!(distance > 0) || !std::isfinite(distance)) {
    return std::nullopt;
  }
  const Eigen::Vector3d p = centre + distance * *ray;
  const auto prediction = predict(solution, command_rad, p, from, surface, state);
  if (!prediction) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 3, 2> m = model::tangents(surface.normal) * 1e-3 * *prediction->mm_per_px;
  return Landing{.p = p, .covariance = m * prediction->covariance * m.transpose()};
}

}  // namespace raysteer::calib::steer
