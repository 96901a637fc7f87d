#include "host/rig/truth_error.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "calib/scene/triangulate.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::TwoViews;

/// Where two cameras see a point, their first one's frame, which is the rig's.
std::optional<Eigen::Vector3d> seen(const TwoViews& views, const calib::steer::LitPoint& point) {
  const std::array match{calib::scene::Match{
      .q_left = point.q[0], .q_right = point.q[1], .cov_left = point.cov_q[0], .cov_right = point.cov_q[1]}};
  const auto rays = calib::scene::ray_pairs(views, match);
  const auto found = calib::scene::triangulate_one(views, match[0], rays[0]);
  return found ? std::optional(found->p) : std::nullopt;
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

Result<TruthError> truth_error(const calib::steer::Solution& solution, const pretend::TruthFile& truth,
                               std::span<const calib::steer::Look> looks) {
  const auto ours = calib::scene::two_views(solution.cameras, 0, 1);
  RAYSTEER_TRY(ours);
  const auto theirs = calib::scene::two_views(truth.rig, 0, 1);
  RAYSTEER_TRY(theirs);
  if (!truth.projector) {
    return fail(RCode::kCalibrationMismatch, "truth.json has no steered projector");
  }
  std::vector<double> pixels;
  std::vector<double> millimetres;
  for (const calib::steer::Look& look : looks) {
    const calib::model::VirtualProjector solved = solution.projector.at(look.command_rad);
    const calib::model::VirtualProjector real = truth.projector->at(look.command_rad);
    for (const calib::steer::LitPoint& point : look.points) {
      const auto p_ours = seen(*ours, point);
      const auto p_real = seen(*theirs, point);
      if (!p_ours || !p_real) {
        continue;
      }
      const auto x_ours = solved.project(*p_ours);
      const auto x_real = real.project(*p_real);
      if (!x_ours || !x_real) {
        continue;
      }
      const auto ray_ours = real.ray(*x_ours);
      const auto ray_real = real.ray(*x_real);
      if (!ray_ours || !ray_real) {
        continue;
      }
      pixels.push_back((*x_ours - *x_real).norm());
      millimetres.push_back(1e3 * (*p_real - real.centre()).norm() * ray_ours->cross(*ray_real).norm());
    }
  }
  if (pixels.empty()) {
    return fail(RCode::kTooFewCorrespondences, "no point of a look that was held out");
  }
  return TruthError{.median_px = quantile(pixels, 0.5),
                    .p95_px = quantile(pixels, 0.95),
                    .median_mm = quantile(millimetres, 0.5),
                    .p95_mm = quantile(millimetres, 0.95),
                    .points = pixels.size()};
}

std::array<Eigen::Vector3d, 4> lit_corners(const AimedStation& station, const pretend::TruthFile& truth,
                                           const std::optional<Eigen::Vector2d>& angles_rad) {
  const Eigen::Vector2d angles = angles_rad.value_or(truth.projector->angles(*station.station.command_rad));
  const calib::model::VirtualProjector view = truth.projector->at_angles(angles);
  const Eigen::Vector3d eye = *truth.T_room_rig * view.centre();
  std::array<Eigen::Vector3d, 4> lit;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto ray = view.ray(station.panel[k]);
    const Eigen::Vector3d direction = truth.T_room_rig->q * ray.value_or(Eigen::Vector3d::Zero());
    const Eigen::Vector3d& corner = station.corners_room[k];
    // A pixel without a ray gives infinity: nothing lights the corner.
    lit[k] = eye + station.normals_room[k].dot(corner - eye) / station.normals_room[k].dot(direction) * direction;
  }
  return lit;
}

}  // namespace raysteer::host::rig
