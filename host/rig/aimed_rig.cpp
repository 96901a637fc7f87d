#include "host/rig/aimed_rig.hpp"

#include <utility>

#include "host/rig/read_files.hpp"

namespace raysteer::host::rig {

Result<AimedRig> read_aimed_rig(const std::string& rig, const std::string& stations, const std::string& surface) {
  auto calibration = exchange::read_rig(rig);
  RAYSTEER_TRY(calibration);
  auto room = calibration->in_room();
  if (!room) {
    return fail(RCode::kDatumsMissing,
                rig + " is not tied to a room, stations are places in one; calibrate it with --survey");
  }
  auto wanted = read_stations(stations);
  RAYSTEER_TRY(wanted);
  std::optional<Scene> scene;
  if (!surface.empty()) {
    auto read = read_scene(surface, calibration->id);
    RAYSTEER_TRY(read);
    scene = *std::move(read);
  }
  auto aimed = aim_stations(*room, *wanted, scene ? &*scene : nullptr);
  RAYSTEER_TRY(aimed);
  return AimedRig{*std::move(calibration), *std::move(room), *std::move(wanted), std::move(scene), *std::move(aimed)};
}

}  // namespace raysteer::host::rig
