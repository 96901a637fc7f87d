#include "host/rig/verify.hpp"

#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/assess/on_surface.hpp"
#include "calib/bake/lit_content.hpp"
#include "calib/model/steered_parameters.hpp"
#include "host/rig/measured_pixel.hpp"

namespace raysteer::host::rig {
namespace {

constexpr double kSameCommandRad = 1e-5;
constexpr double kOnPlaneM = 0.01;  // what stands higher is something else

Error too_few(const AimedStation& station, std::size_t points) {
  return fail(RCode::kTooFewCorrespondences, "station '" + station.station.name + "': " + std::to_string(points) +
                                                 " points on its surface, at least " + std::to_string(kFewestAround) +
                                                 " are needed around a corner");
}

void add_corner(VerifiedStation& verified, std::size_t k, const Eigen::Vector2d& off_m,
                const Eigen::Matrix2d& covariance_m2) {
  verified.off_mm[k] = 1e3 * off_m;
  verified.corner_mm[k] = verified.off_mm[k].norm();
  verified.sure_mm[k] = 1e3 * calib::assess::radius_95(covariance_m2);
  verified.error_mm = std::max(verified.error_mm, verified.corner_mm[k]);
  verified.bound_95_mm = std::max(verified.bound_95_mm, verified.corner_mm[k] + verified.sure_mm[k]);
}

Result<VerifiedStation> verify_to_scale(const calib::steer::InRoom& rig, const AimedStation& station,
                                        std::vector<SeenPixel> seen) {
  // The picture's axes in the room.
  const std::array<Eigen::Vector3d, 4>& wanted = station.corners_room;
  Eigen::Matrix<double, 3, 2> along;
  along << (wanted[1] - wanted[0]).normalized(), (wanted[3] - wanted[0]).normalized();
  std::erase_if(seen, [&](const SeenPixel& pixel) {
    return std::abs(station.normals_room[0].dot(pixel.p_room - wanted[0])) >= kOnPlaneM;
  });
  VerifiedStation verified{.name = station.station.name};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto measured = measure_pixel(rig, station.panel[k], seen);
    if (!measured) {
      return too_few(station, seen.size());
    }
    add_corner(verified, k, along.transpose() * (measured->p_room - wanted[k]),
               along.transpose() * measured->covariance * along);
  }
  return verified;
}

/// A point of a picture that is looked at: how far it shows another piece than belongs there, across the way it is
/// looked at.
struct Shown {
  const SeenPixel* seen;
  Eigen::Vector2d off_m;
};

std::vector<Shown> shown(const calib::steer::InRoom& rig, const AimedStation& station, std::span<const SeenPixel> seen,
                         const Scene* scene) {
  const calib::bake::Content& content = station.content;
  const calib::bake::StationView view(rig.solution.projector, *station.station.command_rad, content,
                                      scene != nullptr ? &scene->surface : nullptr, {}, {});
  // Content pixels are as large as at the sheet, and larger behind it as an eye sees them.
  const double at_sheet = (content.content_rig * station.station.T_rig_plane.t.homogeneous()).z();
  const double sheet_m = station.station.size_m.x() / station.station.content_px.x();
  std::vector<Shown> found;
  std::vector<std::optional<calib::bake::Placed>> placed;
  for (const SeenPixel& pixel : seen) {
    const Eigen::Vector3d is = content.content_rig * (rig.T_rig_room * pixel.p_room).homogeneous();
    const std::array ray{calib::bake::panel_ray(rig.solution.projector.lens, pixel.x)};
    view.lit(ray, placed);
    if (placed[0] && placed[0]->light > 0 && is.z() > 0) {
      found.push_back({&pixel, sheet_m * is.z() / at_sheet * (is.hnormalized() - placed[0]->content())});
    }
  }
  return found;
}

double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// The middle of what the nearest points say: some may lie on another surface beside a depth edge. How sure: the spread
/// about it, by the median, too (a median's variance is pi / 2 times a mean's), and what all points share.
void add_looked_at(VerifiedStation& verified, std::size_t k, const calib::steer::InRoom& rig,
                   const AimedStation& station, std::vector<Shown> points) {
  constexpr auto kCount = static_cast<std::ptrdiff_t>(kFewestAround);
  std::ranges::partial_sort(points, points.begin() + kCount, {},
                            [&](const Shown& a) { return (a.seen->x - station.panel[k]).norm(); });
  points.resize(kFewestAround);
  Eigen::Vector2d median;
  Eigen::Vector2d variance;
  for (int axis = 0; axis < 2; ++axis) {
    std::vector<double> off;
    std::ranges::transform(points, std::back_inserter(off), [&](const Shown& a) { return a.off_m[axis]; });
    median[axis] = quantile(off, 0.5);
    std::ranges::transform(off, off.begin(), [&](double one) { return std::abs(one - median[axis]); });
    const double sigma = 1.4826 * quantile(std::move(off), 0.5);
    variance[axis] = std::numbers::pi / 2 * sigma * sigma / static_cast<double>(kFewestAround);
  }
  const Eigen::Matrix<double, 3, 2> across = calib::model::tangents(station.sights_room[k]);
  const Eigen::Matrix2d common = across.transpose() * common_covariance(rig, points.front().seen->by) * across;
  // Axes of the picture and across the sight differ by a turn: the noise is made round, so that it does not matter.
  add_corner(verified, k, median, common + variance.maxCoeff() * Eigen::Matrix2d::Identity());
}

Result<VerifiedStation> verify_looked_at(const calib::steer::InRoom& rig, const AimedStation& station,
                                         std::span<const SeenPixel> seen, const Scene* scene) {
  const std::vector<Shown> points = shown(rig, station, seen, scene);
  if (points.size() < kFewestAround) {
    return too_few(station, points.size());
  }
  VerifiedStation verified{.name = station.station.name};
  std::vector<double> off;
  std::ranges::transform(points, std::back_inserter(off), [](const Shown& point) { return point.off_m.norm(); });
  verified.points = points.size();
  verified.picture_95_mm = 1e3 * quantile(std::move(off), 0.95);
  for (std::size_t k = 0; k < 4; ++k) {
    add_looked_at(verified, k, rig, station, points);
  }
  return verified;
}

}  // namespace

const calib::steer::Look* look_at(std::span<const calib::steer::Look> looks, const AimedStation& station) {
  const auto found = std::ranges::find_if(looks, [&](const calib::steer::Look& look) {
    return (look.command_rad - *station.station.command_rad).norm() < kSameCommandRad;
  });
  return found == looks.end() ? nullptr : &*found;
}

Result<VerifiedStation> verify_station(const calib::steer::InRoom& rig, const AimedStation& station,
                                       const calib::steer::Look& look, const Scene* scene) {
  std::vector<SeenPixel> seen = seen_pixels(rig, look);
  return station.to_scale ? verify_to_scale(rig, station, std::move(seen))
                          : verify_looked_at(rig, station, seen, scene);
}

}  // namespace raysteer::host::rig
