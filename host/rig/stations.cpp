#include "host/rig/stations.hpp"

#include <algorithm>
#include <numbers>

#include "calib/assess/on_surface.hpp"
#include "calib/bake/aim.hpp"

namespace raysteer::host::rig {
namespace {

Eigen::Vector3d vector(const proto::stations::Vec3& v) { return {v[0], v[1], v[2]}; }

/// A stations file has y up the picture and z out of the surface; tables have y down it and z into the surface.
calib::model::Pose room_content(const proto::stations::Station& station) {
  const calib::model::Pose T_room_station{
      calib::model::rotation_by(std::numbers::pi / 180 * vector(station.rotation_deg)), vector(station.position_m)};
  return T_room_station *
         calib::model::Pose{calib::model::rotation_by(std::numbers::pi * Eigen::Vector3d::UnitX()), {0, 0, 0}};
}

}  // namespace

Result<std::vector<AimedStation>> aim_stations(const calib::steer::InRoom& rig,
                                               const proto::stations::Stations& stations) {
  std::vector<AimedStation> aimed;
  for (const proto::stations::Station& wanted : stations.stations) {
    if (wanted.surface == proto::stations::Surface::kScan || wanted.eye_m) {
      return fail(RCode::kBadValue, "station '" + wanted.name +
                                        "': expected one on its own plane; a scanned surface and an eye are not "
                                        "supported here yet");
    }
    AimedStation one;
    const calib::model::Pose T_room_content = room_content(wanted);
    one.station.name = wanted.name;
    one.station.T_rig_plane = rig.T_rig_room * T_room_content;
    one.station.size_m = {wanted.size_m[0], wanted.size_m[1]};
    one.station.content_px = {1600, static_cast<int>(1600 * wanted.size_m[1] / wanted.size_m[0])};
    one.station.tolerance_mm = wanted.tolerance_mm;
    const auto command = calib::bake::station_command(rig.solution.projector, one.station);
    if (!command) {
      return with_context(command.error(), "station '" + wanted.name + "'");
    }
    one.station.command_rad = *command;
    one.normal_room = T_room_content.q * Eigen::Vector3d(0, 0, -1);
    const auto corners = calib::bake::corners(one.station);
    const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
    std::ranges::transform(corners, one.corners_room.begin(),
                           [&](const Eigen::Vector3d& corner) { return T_room_rig * corner; });
    const auto bounds = calib::assess::corner_bounds(rig, *command, one.corners_room, one.normal_room);
    if (!bounds) {
      return fail(RCode::kStationOutOfReach, "station '" + wanted.name + "': a corner is behind the projector's lens");
    }
    for (std::size_t k = 0; k < 4; ++k) {
      one.panel[k] = (*bounds)[k].x;
      one.bound_95_mm[k] = (*bounds)[k].error_95_mm;
    }
    one.worst_95_mm = std::ranges::max(one.bound_95_mm);
    aimed.push_back(std::move(one));
  }
  return aimed;
}

}  // namespace raysteer::host::rig
