#include "calib/assess/rig_difference.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "calib/assess/on_surface.hpp"
#include "calib/model/steered_parameters.hpp"

namespace raysteer::calib::assess {
namespace {

constexpr std::size_t kFewest = 6;
constexpr double kMilli = 1e-3;

/// Where a pixel lands, the surface's frame.
std::optional<Eigen::Vector3d> landing(const steer::InRoom& rig, const model::Pose& T_frame_rig, const LitPlace& place,
                                       const steer::Surface& surface) {
  const model::VirtualProjector view = rig.solution.projector.at(place.command_rad);
  const auto ray = view.ray(place.x);
  if (!ray) {
    return std::nullopt;
  }
  const Eigen::Vector3d from = T_frame_rig * view.centre();
  const Eigen::Vector3d along = T_frame_rig.q * *ray;
  const double way = surface.normal.dot(surface.point - from) / surface.normal.dot(along);
  return way > 0 && std::isfinite(way) ? std::optional<Eigen::Vector3d>(from + way * along) : std::nullopt;
}

/// Of where it lands, m^2 along the surface's tangents; the mirror's repeatability left out.
Eigen::Matrix2d covariance(const steer::InRoom& rig, const LitPlace& place, const Eigen::Vector3d& p,
                           const Eigen::Vector3d& normal) {
  const steer::LookState still{.covariance_rad2 = Eigen::Matrix2d::Zero()};
  const auto predicted = steer::predict_in_room(rig, place.command_rad, p, normal, still);
  const auto mm2 = predicted ? predicted->covariance_mm2() : std::nullopt;
  if (!mm2) {
    return Eigen::Matrix2d::Zero();
  }
  // predict_in_room() has its axes in the rig's frame.
  const Eigen::Matrix<double, 3, 2> axes =
      rig.T_rig_room.rotation().transpose() * model::tangents(rig.T_rig_room.q * normal);
  const Eigen::Matrix2d turn = model::tangents(normal).transpose() * axes;
  return kMilli * kMilli * turn * *mm2 * turn.transpose();
}

/// The old rig moved as a whole about `middle` by each of six numbers: what that does to the places it lights.
Eigen::Matrix<double, 3, 6> by_whole(const steer::InRoom& rig, const LitPlace& place, const steer::Surface& surface,
                                     const Eigen::Vector3d& middle) {
  constexpr double kStep = 1e-6;
  const model::Pose T_frame_rig = rig.T_rig_room.inverse();
  const model::Pose about{Eigen::Quaterniond::Identity(), middle};
  Eigen::Matrix<double, 3, 6> by = Eigen::Matrix<double, 3, 6>::Zero();
  for (int k = 0; k < 6; ++k) {
    const auto moved = [&](double step) {
      const model::Pose nudge = model::moved_by({}, step * Eigen::Matrix<double, 6, 1>::Unit(k));
      return landing(rig, about * nudge * about.inverse() * T_frame_rig, place, surface);
    };
    const auto ahead = moved(kStep);
    const auto behind = moved(-kStep);
    if (ahead && behind) {
      by.col(k) = (*ahead - *behind) / (2 * kStep);
    }
  }
  return by;
}

/// The movement that explains most, within what a mount can do: three of the six numbers hardly differ in what they do
/// to a plane seen from afar, and would otherwise cancel each other metres away.
Eigen::Matrix<double, 6, 1> whole_movement(const steer::InRoom& before, const steer::Surface& surface,
                                           const std::vector<MovedPlace>& places, const Eigen::Vector3d& middle) {
  constexpr double kNoise = 1e-4;                     // metres
  constexpr double kMountRad = 0.03, kMountM = 0.03;  // one standard deviation
  Eigen::Matrix<double, 6, 1> prior;
  prior << Eigen::Vector3d::Constant(1 / kMountRad), Eigen::Vector3d::Constant(1 / kMountM);
  Eigen::Matrix<double, 6, 6> h = (kNoise * kNoise * prior.cwiseAbs2()).asDiagonal();
  Eigen::Matrix<double, 6, 1> g = Eigen::Matrix<double, 6, 1>::Zero();
  for (const MovedPlace& place : places) {
    const Eigen::Matrix<double, 3, 6> by = by_whole(before, place.lit, surface, middle);
    h += by.transpose() * by;
    g += by.transpose() * place.moved_m;
  }
  return h.ldlt().solve(g);
}

}  // namespace

steer::InRoom in_own_frame(const steer::Solution& solution) {
  const Eigen::Index n = solution.covariance.rows();
  steer::InRoom rig{.solution = solution, .T_rig_room = {}, .covariance = Eigen::MatrixXd::Zero(n + 6, n + 6)};
  rig.covariance.topLeftCorner(n, n) = solution.covariance;
  return rig;
}

Result<RigDifference> rig_difference(const steer::InRoom& now, const steer::InRoom& before,
                                     const steer::Surface& surface, std::span<const LitPlace> places) {
  const model::SteeredProjector& a = now.solution.projector;
  const model::SteeredProjector& b = before.solution.projector;
  if (a.kind != b.kind || a.lens.width != b.lens.width || a.lens.height != b.lens.height) {
    return fail(RCode::kCalibrationMismatch,
                "the earlier calibration is of another rig: its mirror is of another kind or its panel has " +
                    std::to_string(b.lens.width) + " x " + std::to_string(b.lens.height) + " pixels, expected " +
                    std::to_string(a.lens.width) + " x " + std::to_string(a.lens.height));
  }
  RigDifference difference;
  for (const LitPlace& place : places) {
    const auto p = landing(now, now.T_rig_room.inverse(), place, surface);
    const auto old = landing(before, before.T_rig_room.inverse(), place, surface);
    if (p && old) {
      const Eigen::Matrix2d both =
          covariance(now, place, *p, surface.normal) + covariance(before, place, *old, surface.normal);
      difference.places.push_back(
          {.lit = place, .p = *p, .moved_m = *p - *old, .inside_m = *p - *old, .chance_95_mm = 1e3 * radius_95(both)});
    }
  }
  std::vector<MovedPlace>& found = difference.places;
  if (found.size() < kFewest) {
    return fail(RCode::kTooFewCorrespondences, "both calibrations put " + std::to_string(found.size()) +
                                                   " places on the surface; expected at least 6");
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const auto count = static_cast<double>(found.size());
  for (const MovedPlace& place : found) {
    middle += place.p / count;
  }
  difference.whole = whole_movement(before, surface, found, middle);
  std::vector<double> millimetres;
  double whole = 0;
  double inside = 0;
  for (MovedPlace& place : found) {
    const Eigen::Vector3d explained = by_whole(before, place.lit, surface, middle) * difference.whole;
    place.inside_m = place.moved_m - explained;
    millimetres.push_back(1e3 * place.moved_m.norm());
    difference.mean_mm += millimetres.back() / count;
    whole += explained.squaredNorm() / count;
    inside += place.inside_m.squaredNorm() / count;
    difference.beyond_chance += place.beyond_chance() ? 1 / count : 0;
  }
  difference.whole_rms_mm = 1e3 * std::sqrt(whole);
  difference.inside_rms_mm = 1e3 * std::sqrt(inside);
  std::ranges::sort(millimetres);
  difference.p95_mm = millimetres[static_cast<std::size_t>(0.95 * (count - 1) + 0.5)];
  difference.max_mm = millimetres.back();
  return difference;
}

}  // namespace raysteer::calib::assess
