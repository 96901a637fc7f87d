#include "host/rig/verify.hpp"

#include <algorithm>
#include <utility>

#include "calib/scene/triangulate.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::host::rig {
namespace {

constexpr double kSameCommandRad = 1e-5;
constexpr double kOnPlaneM = 0.01;   // what stands higher is something else
constexpr std::size_t kFewest = 12;  // a quadratic has six numbers
constexpr std::size_t kNearest = 30;

struct Landed {
  Eigen::Vector2d x;  // panel px
  Eigen::Vector2d p;  // metres, content frame
};

/// Points of the look on the station's plane.
std::vector<Landed> landed(const AimedStation& station, const calib::steer::Look& look,
                           const calib::scene::TwoViews& views) {
  const calib::model::Pose T_plane_rig = station.station.T_rig_plane.inverse();
  std::vector<Landed> found;
  for (const calib::steer::LitPoint& point : look.points) {
    const std::array match{calib::scene::Match{
        .q_left = point.q[0], .q_right = point.q[1], .cov_left = point.cov_q[0], .cov_right = point.cov_q[1]}};
    const auto seen = calib::scene::triangulate_one(views, match[0], calib::scene::ray_pairs(views, match)[0]);
    if (!seen) {
      continue;
    }
    const Eigen::Vector3d p = T_plane_rig * seen->p;
    if (std::abs(p.z()) < kOnPlaneM) {
      found.push_back({point.x, p.head<2>()});
    }
  }
  return found;
}

/// The value at x of a quadratic through the nearest points, farther ones counting less.
Eigen::Vector2d at(const Eigen::Vector2d& x, std::vector<Landed> points) {
  const auto distance = [&](const Landed& a) { return (a.x - x).norm(); };
  const std::size_t used = std::min(kNearest, points.size());
  std::ranges::partial_sort(points, points.begin() + static_cast<std::ptrdiff_t>(used), {}, distance);
  const double reach = std::max(distance(points[used - 1]), 1.0);
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 2> right = Eigen::Matrix<double, 6, 2>::Zero();
  for (std::size_t k = 0; k < used; ++k) {
    const Eigen::Vector2d d = (points[k].x - x) / reach;
    Eigen::Vector<double, 6> row;
    row << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y();
    const double weight = 1 / (0.1 + d.squaredNorm());
    normal += weight * row * row.transpose();
    right += weight * row * points[k].p.transpose();
  }
  return normal.ldlt().solve(right).row(0).transpose();
}

}  // namespace

const calib::steer::Look* look_at(std::span<const calib::steer::Look> looks, const AimedStation& station) {
  const auto found = std::ranges::find_if(looks, [&](const calib::steer::Look& look) {
    return (look.command_rad - *station.station.command_rad).norm() < kSameCommandRad;
  });
  return found == looks.end() ? nullptr : &*found;
}

Result<VerifiedStation> verify_station(const calib::steer::InRoom& rig, const AimedStation& station,
                                       const calib::steer::Look& look) {
  const auto views = calib::scene::two_views(rig.solution.cameras, 0, 1);
  RAYSTEER_TRY(views);
  const std::vector<Landed> points = landed(station, look, *views);
  if (points.size() < kFewest) {
    return fail(RCode::kTooFewCorrespondences,
                "station '" + station.station.name + "': " + std::to_string(points.size()) +
                    " points on its plane, at least " + std::to_string(kFewest) + " are needed");
  }
  VerifiedStation verified{.name = station.station.name};
  const Eigen::Vector2d half = 0.5 * station.station.size_m;
  const std::array<Eigen::Vector2d, 4> wanted{-half, {half.x(), -half.y()}, half, {-half.x(), half.y()}};
  for (std::size_t k = 0; k < 4; ++k) {
    verified.corner_mm[k] = 1e3 * (at(station.panel[k], points) - wanted[k]).norm();
  }
  verified.error_mm = std::ranges::max(verified.corner_mm);
  return verified;
}

}  // namespace raysteer::host::rig
