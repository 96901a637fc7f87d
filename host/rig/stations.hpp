// pure: stations of a room as the solved rig sees them: where to aim, and how sure it is of each corner.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <string>
#include <vector>

#include "calib/bake/station.hpp"
#include "calib/steer/room.hpp"
#include "hal/base/result.hpp"
#include "proto/stations/stations.hpp"

namespace raysteer::host::rig {

struct AimedStation {
  calib::bake::Station station;  ///< its command is set
  std::array<Eigen::Vector3d, 4> corners_room;
  Eigen::Vector3d normal_room;           ///< out of the surface
  std::array<Eigen::Vector2d, 4> panel;  ///< px that should light the corners
  std::array<double, 4> bound_95_mm{};   ///< 95 % of errors are below, the mirror's repeatability included
  double worst_95_mm = 0;

  bool within() const { return station.tolerance_mm <= 0 || worst_95_mm <= station.tolerance_mm; }
};

/// Errors: kStationOutOfReach (first station that is), kBadValue (a station for a scanned surface or an eye: not
/// supported yet).
Result<std::vector<AimedStation>> aim_stations(const calib::steer::InRoom& rig,
                                               const proto::stations::Stations& stations);

}  // namespace raysteer::host::rig
