#include "calib/plan/forecast.hpp"

#include <algorithm>
#include <string>

#include "calib/plan/parameters.hpp"

namespace raysteer::calib::plan {
namespace {

constexpr int kColumns = 8;  // of the panel's points that stand for all
constexpr int kRows = 6;
constexpr double kStep = 0.01;  // of a tolerance: curvature and rounding both stay below 1e-5 of the derivative
constexpr double kAngleStep = 1e-5;
constexpr double kMillimetres = 1000;

using Matrix2X = Eigen::Matrix<double, 2, Eigen::Dynamic>;

Status check(const steer::Tolerance& t) {
  const std::array all{t.axis_rad,   t.position_m, t.zero_rad,  t.gain,    t.quadratic,
                       t.cubic,      t.cross_talk, t.focal,     t.aspect,  t.centre,
                       t.distortion, t.tangential, t.mount_rad, t.mount_m, t.repeatability_rad};
  if (!std::ranges::all_of(all, [](double sigma) { return std::isfinite(sigma) && sigma >= 0; })) {
    return fail(RCode::kBadValue, "tolerances: expected finite numbers of at least 0");
  }
  if (!(t.repeatability_rad > 0)) {
    return fail(RCode::kBadValue, "repeatability_rad: expected more than 0, the mirror's spread from look to look");
  }
  return ok();
}

}  // namespace

/// A pixel of the picture that gets out and meets the plane.
struct Forecaster::Sample {
  Eigen::Vector3d p;                     ///< where
  Eigen::Matrix<double, 3, 2> by_pixel;  ///< how that moves with the pixel, m/px
  bool measured = false;                 ///< both cameras see it
};

Forecaster::Forecaster(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                       const Measuring& measuring)
    : drawing_(drawing), cameras_(cameras), plane_(plane), measuring_(measuring) {
  const int count = parameter_count(drawing.projector.kind);
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(count, i);
    off_.push_back({moved(drawing, step), moved(drawing, -step)});
  }
}

Result<Forecaster> Forecaster::make(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                                    const Measuring& measuring) {
  if (cameras.devices.size() != 2) {
    return fail(RCode::kBadValue,
                "expected two cameras, left and right, got " + std::to_string(cameras.devices.size()));
  }
  for (const model::Device& device : cameras.devices) {
    RAYSTEER_TRY(model::check(device.camera));
  }
  RAYSTEER_TRY(model::check(drawing.projector.lens));
  RAYSTEER_TRY(check(drawing.tolerance));
  if (!(std::abs(plane.normal.norm() - 1) < 1e-6) || !std::isfinite(plane.distance_m) || plane.distance_m == 0) {
    return fail(RCode::kBadValue, "plane: expected a unit normal and a distance from the rig that is not 0");
  }
  if (!(measuring.noise_px > 0) || measuring.points_per_look < 1) {
    return fail(RCode::kBadValue, "noise_px and points_per_look: expected more than 0");
  }
  return Forecaster(drawing, cameras, plane, measuring);
}

bool Forecaster::seen_by_both(const Eigen::Vector3d& p, double border_px) const {
  return std::ranges::all_of(cameras_.devices, [&](const model::Device& device) {
    const auto q = device.camera.project(device.T_device_rig * p);
    return q && q->minCoeff() > border_px && q->x() < device.camera.width - 1 - border_px &&
           q->y() < device.camera.height - 1 - border_px;
  });
}

bool Forecaster::usable(const Eigen::Vector2d& command_rad) const {
  const model::SteeredProjector& projector = drawing_.projector;
  if (!projector.in_range(command_rad)) {
    return false;
  }
  const Eigen::Vector2d middle((projector.lens.width - 1) / 2.0, (projector.lens.height - 1) / 2.0);
  const auto p = lit_on(plane_, projector.at(command_rad), middle);
  if (!p || !seen_by_both(*p, measuring_.border_px)) {
    return false;
  }
  const model::MirrorOutlines outlines(projector, projector.angles(command_rad));
  return outlines.passes(middle) && outlines.passing_part() >= measuring_.passing_part;
}

/// Covariance of a point from its two camera pixels, m^2.
Eigen::Matrix3d Forecaster::triangulated(const Eigen::Vector3d& p) const {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const model::Device& device : cameras_.devices) {
    Eigen::Matrix<double, 2, 3> by_point;
    if (device.camera.project(device.T_device_rig * p, by_point)) {
      const Eigen::Matrix<double, 2, 3> J = by_point * device.T_device_rig.rotation() / measuring_.noise_px;
      information += J.transpose() * J;
    }
  }
  return information.inverse();
}

std::vector<Forecaster::Sample> Forecaster::samples(const Eigen::Vector2d& command_rad) const {
  const model::SteeredProjector& projector = drawing_.projector;
  const model::VirtualProjector view = projector.at(command_rad);
  const model::MirrorOutlines outlines(projector, projector.angles(command_rad));
  std::vector<Sample> found;
  for (int j = 0; j < kRows; ++j) {
    for (int i = 0; i < kColumns; ++i) {
      const Eigen::Vector2d x((i + 0.5) * projector.lens.width / kColumns - 0.5,
                              (j + 0.5) * projector.lens.height / kRows - 0.5);
      const auto p = lit_on(plane_, view, x);
      const auto right = lit_on(plane_, view, x + Eigen::Vector2d::UnitX());
      const auto below = lit_on(plane_, view, x + Eigen::Vector2d::UnitY());
      if (p && right && below && outlines.passes(x)) {
        Sample sample{.p = *p, .by_pixel = {}, .measured = seen_by_both(*p, 0)};
        sample.by_pixel << *right - *p, *below - *p;
        found.push_back(sample);
      }
    }
  }
  return found;
}

std::optional<LookForecast> Forecaster::at(const Eigen::Vector2d& command_rad) const {
  const std::vector<Sample> found = samples(command_rad);
  const auto measured = std::ranges::count_if(found, &Sample::measured);
  constexpr int kFewest = 6;
  if (measured < kFewest) {
    return std::nullopt;
  }
  const Eigen::Index n = parameters();
  const auto points = static_cast<Eigen::Index>(found.size());

  // Derivatives of the pixel that lights each point, by parameters and by the two angles.
  Eigen::MatrixXd J(2 * points, n);
  const auto column = [&](auto into, const model::VirtualProjector& more, const model::VirtualProjector& less,
                          double step) {
    for (Eigen::Index i = 0; i < points; ++i) {
      const Eigen::Vector3d& p = found[static_cast<std::size_t>(i)].p;
      const auto a = more.project(p);
      const auto b = less.project(p);
      into.template segment<2>(2 * i) = a && b ? ((*a - *b) / (2 * step)).eval() : Eigen::Vector2d::Zero().eval();
    }
  };
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& [more, less] = off_[static_cast<std::size_t>(k)];
    column(J.col(k), more.at(command_rad), less.at(command_rad), kStep);
  }
  const Eigen::Vector2d angles = drawing_.projector.angles(command_rad);
  Eigen::MatrixXd J_angle(2 * points, 2);
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = kAngleStep * Eigen::Vector2d::Unit(axis);
    column(J_angle.col(axis), drawing_.projector.at_angles(angles + step), drawing_.projector.at_angles(angles - step),
           kAngleStep);
  }

  LookForecast look{.command_rad = command_rad, .information = {}, .spread_px = {}, .spread_mm = {}};
  const double repeatability = drawing_.tolerance.repeatability_rad;
  const double weight = 1.0 / static_cast<double>(points);
  Eigen::MatrixXd J_mm(3 * points, n);
  for (Eigen::Index i = 0; i < points; ++i) {
    const auto& by_pixel = found[static_cast<std::size_t>(i)].by_pixel;
    J_mm.middleRows<3>(3 * i) = kMillimetres * by_pixel * J.middleRows<2>(2 * i);
    look.repeatability_mm2 +=
        weight * (kMillimetres * repeatability * by_pixel * J_angle.middleRows<2>(2 * i)).squaredNorm();
  }
  look.spread_px = weight * (J.transpose() * J);
  look.spread_mm = weight * (J_mm.transpose() * J_mm);
  look.repeatability_px2 = weight * repeatability * repeatability * J_angle.squaredNorm();

  // Whitened: the panel's noise, and the point's as seen on the panel (algorithms 3.1).
  const model::VirtualProjector view = drawing_.projector.at(command_rad);
  const double share = static_cast<double>(measuring_.points_per_look) / (kColumns * kRows);
  for (Eigen::Index i = 0; i < points; ++i) {
    const Sample& sample = found[static_cast<std::size_t>(i)];
    Eigen::Matrix<double, 2, 3> by_point;
    if (!sample.measured || !view.lens.project(view.rotation * sample.p + view.translation, by_point)) {
      J.middleRows<2>(2 * i).setZero();
      J_angle.middleRows<2>(2 * i).setZero();
      continue;
    }
    by_point *= view.rotation;
    const Eigen::Matrix2d covariance = measuring_.noise_px * measuring_.noise_px * Eigen::Matrix2d::Identity() +
                                       by_point * triangulated(sample.p) * by_point.transpose();
    const Eigen::LLT<Eigen::Matrix2d> root(covariance / share);
    J.middleRows<2>(2 * i) = root.matrixL().solve(J.middleRows<2>(2 * i).eval());
    J_angle.middleRows<2>(2 * i) = root.matrixL().solve(J_angle.middleRows<2>(2 * i).eval());
  }
  const Matrix2X cross = J_angle.transpose() * J;
  const Eigen::Matrix2d latent =
      J_angle.transpose() * J_angle + Eigen::Matrix2d::Identity() / (repeatability * repeatability);
  look.information = J.transpose() * J - cross.transpose() * latent.inverse() * cross;
  return look;
}

}  // namespace raysteer::calib::plan
