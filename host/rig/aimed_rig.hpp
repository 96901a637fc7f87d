// A rig's calibration, its room and the stations wanted there, read from their files and aimed at.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/exchange/rig_file.hpp"
#include "host/rig/stations.hpp"

namespace raysteer::host::rig {

struct AimedRig {
  exchange::RigCalibration calibration;
  calib::steer::InRoom room;
  proto::stations::Stations wanted;
  std::optional<Scene> scene;  ///< where a surface was given
  std::vector<AimedStation> aimed;
};

/// `rig`: a calibration's file or folder; `stations`: a stations file, or an installed one's name; `surface`: what
/// 'raysteer scan --rig' made, its folder, or empty. Errors: those of the readers and of aim_stations();
/// kDatumsMissing: the rig is not tied to a room, and stations are places in one.
Result<AimedRig> read_aimed_rig(const std::string& rig, const std::string& stations, const std::string& surface = "");

}  // namespace raysteer::host::rig
