#include "host/rig/aimed_rig.hpp"

#include <utility>

#include "host/rig/read_files.hpp"

namespace raysteer::host::rig {

Result<AimedRig> read_aimed_rig(const std::string& rig, const std::string& stations) {
  auto calibration = exchange::read_rig(rig);
  RAYSTEER_TRY(calibration);
  auto room = calibration->in_room();
  if (!room) {
    return fail(RCode::kDatumsMissing,
                rig + " is not tied to a room, stations are places in one; calibrate it with --survey");
  }
  auto wanted = read_stations(stations);
  RAYSTEER_TRY(wanted);
  auto aimed = aim_stations(*room, *wanted);
  RAYSTEER_TRY(aimed);
  return AimedRig{*std::move(calibration), *std::move(room), *std::move(wanted), *std::move(aimed)};
}

}  // namespace raysteer::host::rig
