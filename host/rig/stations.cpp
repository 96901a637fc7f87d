#include "host/rig/stations.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "calib/assess/on_relief.hpp"
#include "calib/assess/on_surface.hpp"
#include "calib/bake/aim.hpp"

namespace raysteer::host::rig {
namespace {

using calib::bake::Content;
using calib::steer::InRoom;
using Eigen::Vector2d;
using Eigen::Vector3d;

Vector3d vector(const proto::stations::Vec3& v) { return {v[0], v[1], v[2]}; }

/// A stations file has y up the picture and z out of the surface; tables have y down it and z into the surface.
calib::model::Pose room_content(const proto::stations::Station& station) {
  const calib::model::Pose T_room_station{
      calib::model::rotation_by(std::numbers::pi / 180 * vector(station.rotation_deg)), vector(station.position_m)};
  return T_room_station *
         calib::model::Pose{calib::model::rotation_by(std::numbers::pi * Eigen::Vector3d::UnitX()), {0, 0, 0}};
}

/// Names the station; what `calib/bake` refuses is named there.
Error refused(RCode rcode, const std::string& name, const std::string& why) {
  return fail(rcode, "station '" + name + "': " + why);
}

/// The picture as a sheet of its size that faces the eye at the station's middle, its top towards the station's.
Result<Content> faced_content(const calib::bake::Station& station, const Vector3d& eye_rig, bool on_scan) {
  const Vector3d way = station.T_rig_plane.t - eye_rig;
  const Vector3d ahead = way.normalized();
  const Vector3d down = station.T_rig_plane.q * Vector3d::UnitY();
  const Vector3d across = down - ahead * ahead.dot(down);
  if (!(way.norm() > 0.01) || !(across.norm() > 0.01)) {
    return refused(RCode::kBadValue, station.name,
                   "expected an eye that does not look along the picture's top, nor from within 10 mm of it; "
                   "move eye_m or turn the station");
  }
  Eigen::Matrix3d R_eye_rig;
  R_eye_rig.row(2) = ahead.transpose();
  R_eye_rig.row(1) = across.normalized().transpose();
  R_eye_rig.row(0) = across.normalized().cross(ahead).transpose();
  const Vector2d size_px = station.content_px.cast<double>();
  Content content = calib::bake::seen_content(
      station.name, {.q = Eigen::Quaterniond(R_eye_rig), .t = -(R_eye_rig * eye_rig)},
      size_px.x() * way.norm() / station.size_m.x(), 0.5 * (size_px - Vector2d::Ones()), station.content_px,
      on_scan ? std::nullopt : calib::bake::metric_content(station).plane);
  content.tolerance_m = 1e-3 * station.tolerance_mm;
  return content;
}

/// Where a pixel of content lies, rig frame; nothing where there is no surface.
std::optional<ScannedPlace> place_of(const Content& content, const Vector2d& uv, const Scene* scene) {
  const calib::bake::Sight sight = calib::bake::sight(content, uv);
  if (!content.plane) {
    return scene->first(sight.origin, sight.direction);
  }
  const double way = (content.plane->distance_m - content.plane->normal.dot(sight.origin)) /
                     content.plane->normal.dot(sight.direction);
  return way > 0 && std::isfinite(way)
             ? std::optional(ScannedPlace{.p = sight.origin + way * sight.direction, .normal = content.plane->normal})
             : std::nullopt;
}

/// Share of the picture under which the scan has no surface. Strips beside depth edges are hidden from an eye.
double missing_share(const Content& content, const Scene* scene) {
  constexpr int kParts = 24;
  int missing = 0;
  for (int i = 0; i <= kParts; ++i) {
    for (int j = 0; j <= kParts; ++j) {
      const Vector2d share(i / double{kParts}, j / double{kParts});
      const Vector2d uv = share.cwiseProduct(content.content_px.cast<double>()) - Vector2d(0.5, 0.5);
      missing += place_of(content, uv, scene) ? 0 : 1;
    }
  }
  return missing / double{(kParts + 1) * (kParts + 1)};
}

Status aim_to_scale(const InRoom& rig, const Vector3d& normal_room, AimedStation& one) {
  one.content = calib::bake::metric_content(one.station);
  const auto command = calib::bake::station_command(rig.solution.projector, one.station);
  RAYSTEER_TRY(command);
  one.station.command_rad = *command;
  const auto corners = calib::bake::corners(one.station);
  const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
  std::ranges::transform(corners, one.corners_room.begin(),
                         [&](const Vector3d& corner) { return T_room_rig * corner; });
  one.normals_room.fill(normal_room);
  one.sights_room.fill(-normal_room);
  return set_bounds(rig, {}, one);
}

/// A station on the scanned surface, or drawn for an eye.
Status aim_looked_at(const InRoom& rig, const std::optional<Vector3d>& eye_rig, bool on_scan, const Scene* scene,
                     AimedStation& one) {
  one.to_scale = false;
  if (on_scan && scene == nullptr) {
    return refused(RCode::kSurfaceMissing, one.station.name,
                   "it lies on a scanned surface; name the scan with --surface");
  }
  if (eye_rig) {
    auto content = faced_content(one.station, *eye_rig, on_scan);
    RAYSTEER_TRY(content);
    one.content = *std::move(content);
  } else {
    one.content = calib::bake::draped_content(one.station);
  }
  if (on_scan) {
    constexpr double kMostMissing = 0.15;
    one.missing = missing_share(one.content, scene);
    if (one.missing > kMostMissing) {
      return refused(RCode::kSurfaceMissing, one.station.name,
                     "the scan lacks " + std::to_string(std::lround(100 * one.missing)) +
                         " % of the surface under its picture; expected at most " +
                         std::to_string(std::lround(100 * kMostMissing)) + " %");
    }
  }
  const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
  const Vector2d most = one.content.content_px.cast<double>() - Vector2d(0.5, 0.5);
  const std::array<Vector2d, 4> uv{Vector2d(-0.5, -0.5), {most.x(), -0.5}, most, {-0.5, most.y()}};
  std::array<Vector3d, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto place = place_of(one.content, uv[k], scene);
    const std::string corner = std::string("its ") + calib::bake::kCornerNames[k] + " corner";
    if (!place && on_scan) {
      return refused(RCode::kSurfaceMissing, one.station.name, "the scan has nothing at " + corner);
    }
    if (!place) {
      return refused(RCode::kStationOutOfReach, one.station.name,
                     "seen from its eye, " + corner + " lies beyond its plane's horizon");
    }
    corners[k] = place->p;
    one.scan_sigma_m[k] = on_scan ? std::optional(place->sigma_m) : std::nullopt;
    one.corners_room[k] = T_room_rig * place->p;
    one.normals_room[k] = T_room_rig.q * place->normal;
    one.sights_room[k] = T_room_rig.q * calib::bake::sight(one.content, uv[k]).direction;
  }
  const auto command = calib::bake::command_showing(rig.solution.projector, one.station.name, corners);
  RAYSTEER_TRY(command);
  one.station.command_rad = *command;
  return set_bounds(rig, {}, one);
}

}  // namespace

Status set_bounds(const InRoom& rig, calib::steer::LookState state, AimedStation& station) {
  const Vector2d command = *station.station.command_rad;
  std::vector<calib::assess::CornerBound> bounds;
  if (station.to_scale) {
    auto all = calib::assess::corner_bounds(rig, command, station.corners_room, station.normals_room[0], state);
    if (!all) {
      return refused(RCode::kStationOutOfReach, station.station.name, "a corner is behind the projector's lens");
    }
    bounds = *std::move(all);
  } else {
    for (std::size_t k = 0; k < 4; ++k) {
      const auto bound = calib::assess::place_bound(rig, command,
                                                    {.p_room = station.corners_room[k],
                                                     .normal_room = station.normals_room[k],
                                                     .sight_room = station.sights_room[k],
                                                     .scan_sigma_m = station.scan_sigma_m[k]},
                                                    state);
      if (!bound) {
        return refused(RCode::kStationOutOfReach, station.station.name,
                       "a corner is behind the projector's lens or hidden from an eye");
      }
      bounds.push_back(*bound);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    station.panel[k] = bounds[k].x;
    station.bound_95_mm[k] = bounds[k].error_95_mm;
  }
  station.worst_95_mm = std::ranges::max(station.bound_95_mm);
  station.state = std::move(state);
  return ok();
}

Result<std::vector<AimedStation>> aim_stations(const InRoom& rig, const proto::stations::Stations& stations,
                                               const Scene* scene) {
  std::vector<AimedStation> aimed;
  for (const proto::stations::Station& wanted : stations.stations) {
    AimedStation one;
    const calib::model::Pose T_room_content = room_content(wanted);
    one.station.name = wanted.name;
    one.station.T_rig_plane = rig.T_rig_room * T_room_content;
    one.station.size_m = {wanted.size_m[0], wanted.size_m[1]};
    one.station.content_px = {1600, static_cast<int>(1600 * wanted.size_m[1] / wanted.size_m[0])};
    one.station.tolerance_mm = wanted.tolerance_mm;
    const bool on_scan = wanted.surface == proto::stations::Surface::kScan;
    const auto eye_rig = wanted.eye_m ? std::optional<Vector3d>(rig.T_rig_room * vector(*wanted.eye_m)) : std::nullopt;
    RAYSTEER_TRY(on_scan || eye_rig ? aim_looked_at(rig, eye_rig, on_scan, scene, one)
                                    : aim_to_scale(rig, T_room_content.q * Vector3d(0, 0, -1), one));
    aimed.push_back(std::move(one));
  }
  return aimed;
}

}  // namespace raysteer::host::rig
