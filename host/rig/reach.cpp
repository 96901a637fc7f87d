#include "host/rig/reach.hpp"

#include <algorithm>
#include <cmath>

#include "calib/assess/on_surface.hpp"
#include "calib/bake/aim.hpp"
#include "calib/model/mirror_outline.hpp"
#include "calib/model/steered_parameters.hpp"

namespace raysteer::host::rig {
namespace {

using calib::model::SteeredProjector;
using calib::steer::InRoom;
using calib::steer::Surface;

/// Light that falls flatter than this reaches nothing worth drawing.
constexpr double kLeastCosine = 0.15;

std::optional<Eigen::Vector3d> landing(const InRoom& rig, const Eigen::Vector2d& command, const Eigen::Vector2d& x,
                                       const Surface& surface) {
  const calib::model::VirtualProjector view = rig.solution.projector.at(command);
  const auto ray = view.ray(x);
  if (!ray) {
    return std::nullopt;
  }
  const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
  const Eigen::Vector3d from = T_room_rig * view.centre();
  const Eigen::Vector3d along = T_room_rig.q * *ray;
  const double fall = surface.normal.dot(along);
  const double way = surface.normal.dot(surface.point - from) / fall;
  if (!(way > 0) || !(std::abs(fall) > kLeastCosine)) {
    return std::nullopt;
  }
  return from + way * along;
}

/// The plane through what was measured, in the room's or the rig's frame.
std::optional<Surface> measured_plane(const InRoom& rig) {
  std::vector<Eigen::Vector3d> points;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
  for (const calib::steer::SolvedLook& look : rig.solution.looks) {
    for (const calib::steer::PointResidual& point : look.points) {
      if (point.used) {
        points.push_back(T_room_rig * point.p);
        middle += points.back();
      }
    }
  }
  if (points.size() < 3) {
    return std::nullopt;
  }
  middle /= static_cast<double>(points.size());
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& p : points) {
    scatter += (p - middle) * (p - middle).transpose();
  }
  Eigen::Vector3d normal = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(0);
  if (normal.dot(T_room_rig.t - middle) < 0) {
    normal = -normal;  // towards the rig
  }
  return Surface{.point = middle, .normal = normal};
}

std::optional<double> bound_mm(const InRoom& rig, bool tied, const Eigen::Vector2d& command, const Eigen::Vector2d& x,
                               const Surface& surface) {
  if (!tied) {
    const auto landed = calib::steer::land(rig.solution, command, x, surface);
    if (!landed) {
      return std::nullopt;
    }
    const Eigen::Matrix<double, 3, 2> axes = calib::model::tangents(surface.normal);
    return 1e3 * calib::assess::radius_95(axes.transpose() * landed->covariance * axes);
  }
  const auto p = landing(rig, command, x, surface);
  if (!p) {
    return std::nullopt;
  }
  const auto bounds = calib::assess::corner_bounds(rig, command, {&*p, 1}, surface.normal);
  return bounds ? std::optional(bounds->front().error_95_mm) : std::nullopt;
}

std::vector<Eigen::Vector2d> picture_places(const SteeredProjector& projector) {
  const double right = projector.lens.width - 1;
  const double bottom = projector.lens.height - 1;
  return {calib::bake::panel_middle(projector), {0, 0}, {right, 0}, {right, bottom}, {0, bottom}};
}

}  // namespace

std::optional<Floor> floor_of(const InRoom& rig, bool tied) {
  const std::optional<Surface> measured = measured_plane(rig);
  const SteeredProjector& projector = rig.solution.projector;
  if (tied) {
    Floor floor{.T_floor_frame = {}, .name = "the room's floor (z = 0)"};
    const Eigen::Vector2d rest = 0.5 * (projector.least_rad + projector.most_rad);
    const auto lit = landing(rig, rest, calib::bake::panel_middle(projector), floor.surface());
    const bool lies_there = !measured || std::abs(measured->normal.z()) > 0.95;
    if (lit && lies_there) {
      return floor;
    }
  }
  if (!measured) {
    return std::nullopt;
  }
  // x along the frame's own x as nearly as the plane has it, seen from the rig.
  const Eigen::Vector3d& z = measured->normal;
  const Eigen::Vector3d start = std::abs(z.x()) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  const Eigen::Vector3d x = (start - z.dot(start) * z).normalized();
  Eigen::Matrix3d axes;
  axes << x, z.cross(x), z;
  const Eigen::Quaterniond q(Eigen::Matrix3d(axes.transpose()));
  const Eigen::Vector3d foot = z * z.dot(measured->point);  // of the frame's origin on the plane
  return Floor{.T_floor_frame = {q, -(q * foot)}, .name = "the plane through the measured points"};
}

Reach reach_on(const Floor& floor, const InRoom& rig, bool tied, int columns, int rows) {
  const SteeredProjector& projector = rig.solution.projector;
  const Surface surface = floor.surface();
  const std::vector<Eigen::Vector2d> picture = picture_places(projector);
  const Eigen::Vector2d span = projector.most_rad - projector.least_rad;
  const auto command = [&](double i, double j) -> Eigen::Vector2d {
    return projector.least_rad + span.cwiseProduct(Eigen::Vector2d(i / columns, j / rows));
  };
  const auto lands = [&](double i, double j) -> std::optional<Eigen::Vector2d> {
    const calib::model::MirrorOutlines outlines(projector, projector.angles(command(i, j)));
    const auto p = outlines.passes(picture[0]) ? landing(rig, command(i, j), picture[0], surface) : std::nullopt;
    return p ? std::optional(floor(*p)) : std::nullopt;
  };
  Reach reach;
  std::vector<double> all;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      ReachedCell cell{.command_rad = command(i + 0.5, j + 0.5), .outline_m = {}};
      constexpr std::array<std::array<int, 2>, 4> kCorners{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
      bool whole = true;
      for (std::size_t k = 0; k < kCorners.size(); ++k) {
        const auto corner = lands(i + kCorners[k][0], j + kCorners[k][1]);
        whole = whole && corner.has_value();
        cell.outline_m[k] = corner.value_or(Eigen::Vector2d::Zero());
      }
      if (!whole) {
        continue;
      }
      for (const Eigen::Vector2d& x : picture) {
        cell.worst_95_mm = std::max(cell.worst_95_mm, bound_mm(rig, tied, cell.command_rad, x, surface).value_or(0));
      }
      all.push_back(cell.worst_95_mm);
      reach.cells.push_back(cell);
    }
  }
  std::ranges::sort(all);
  if (!all.empty()) {
    reach.median_95_mm = all[all.size() / 2];
    reach.worst_95_mm = all.back();
  }
  return reach;
}

std::optional<Eigen::Vector2d> middle_on(const Floor& floor, const InRoom& rig, const Eigen::Vector2d& command_rad) {
  const auto p = landing(rig, command_rad, calib::bake::panel_middle(rig.solution.projector), floor.surface());
  return p ? std::optional(floor(*p)) : std::nullopt;
}

std::vector<calib::assess::LitPlace> lit_places(const Reach& reach, const SteeredProjector& projector) {
  std::vector<calib::assess::LitPlace> places;
  for (const ReachedCell& cell : reach.cells) {
    for (const Eigen::Vector2d& x : picture_places(projector)) {
      places.push_back({.command_rad = cell.command_rad, .x = x});
    }
  }
  return places;
}

}  // namespace raysteer::host::rig
