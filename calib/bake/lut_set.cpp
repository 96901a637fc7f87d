#include "calib/bake/lut_set.hpp"

#include <optional>

#include "calib/bake/aim.hpp"
#include "calib/bake/in_parallel.hpp"

namespace raysteer::calib::bake {
namespace {

using proto::lut::LutSet;
using proto::lut::WarpMap;

Status check(const model::SteeredProjector& projector, const LutSetRequest& request) {
  RAYSTEER_TRY(model::check(projector.lens));
  constexpr double kMostCommand = 2;  // rad: what nanoradians in 32 bits hold
  if (!(projector.least_rad.minCoeff() >= -kMostCommand && projector.most_rad.maxCoeff() <= kMostCommand &&
        (projector.least_rad.array() < projector.most_rad.array()).all())) {
    return fail(RCode::kBadValue, "the mirror's range must be finite, rising and within 2 rad either way");
  }
  for (const proto::lut::KeepOut& zone : request.keep_out) {
    RAYSTEER_TRY(proto::lut::check(zone));
  }
  for (const PlacedContent& one : request.further) {
    RAYSTEER_TRY(bake::check(one.content));
    if (!one.command_rad.allFinite()) {
      return fail(RCode::kNotFinite, "the command of '" + one.content.name + "' is not finite");
    }
    if (!one.content.plane && request.scene == nullptr) {
      return fail(RCode::kBadValue, "content '" + one.content.name + "' has neither a plane nor a scanned surface");
    }
    if (!projector.in_range(one.command_rad)) {
      return fail(RCode::kStationOutOfReach, "the command of '" + one.content.name + "' is out of the mirror's range");
    }
  }
  for (const Station& station : request.stations) {
    RAYSTEER_TRY(bake::check(station));
    RAYSTEER_TRY(bake::check(metric_content(station)));
  }
  return ok();
}

}  // namespace

Result<LutSet> bake_lut_set(const model::SteeredProjector& projector, const LutSetRequest& request) {
  RAYSTEER_TRY(check(projector, request));
  auto steering = bake_steering(projector, request.steering);
  RAYSTEER_TRY(steering);
  std::vector<PlacedContent> placed;
  for (const Station& station : request.stations) {
    const auto command = station_command(projector, station);
    RAYSTEER_TRY(command);
    placed.push_back(
        {.content = metric_content(station), .command_rad = *command, .stands_as_rad = station.stands_as_rad});
  }
  placed.insert(placed.end(), request.further.begin(), request.further.end());

  const PanelRays rays(projector.lens, request.threads);
  const KeepOutFloor floor{.T_plane_rig = request.steering.T_rig_plane.inverse(), .zones = request.keep_out};
  std::vector<std::optional<Result<WarpMap>>> maps(placed.size());
  in_parallel(static_cast<int>(placed.size()), request.threads, [&](int i) {
    const PlacedContent& one = placed[static_cast<std::size_t>(i)];
    const StationView view(projector, one.stands_as_rad.value_or(one.command_rad), one.content, request.scene, floor,
                           request.warp.light);
    maps[static_cast<std::size_t>(i)] = bake_warp(view, rays, one.command_rad, request.warp);
  });
  LutSet set{.calibration_id = request.calibration_id,
             .board_id = request.board_id,
             .steering = std::move(*steering),
             .keep_out = request.keep_out,
             .maps = {}};
  for (auto& map : maps) {
    RAYSTEER_TRY(*map);
    if (set.find((*map)->parts().name) != nullptr) {
      return fail(RCode::kTableDamaged, "two stations have the name '" + (*map)->parts().name + "'");
    }
    set.maps.push_back(std::move(**map));
  }
  return set;
}

}  // namespace raysteer::calib::bake
