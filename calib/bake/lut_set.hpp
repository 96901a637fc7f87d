// pure: all tables of a solved rig for its device.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/bake/steering.hpp"
#include "calib/bake/warp.hpp"
#include "proto/lut/lut_set.hpp"

namespace raysteer::calib::bake {

/// Content at a command of one's own choice: draped, or seen from a place.
struct PlacedContent {
  Content content;
  Eigen::Vector2d command_rad;
  std::optional<Eigen::Vector2d> stands_as_rad = std::nullopt;  ///< as a Station's
};

struct LutSetRequest {
  std::string calibration_id;
  std::string board_id;
  SteeringRequest steering;
  std::vector<proto::lut::KeepOut> keep_out;  ///< in the steering plane
  std::vector<Station> stations;              ///< to scale on their planes, each at its station_command()
  std::vector<PlacedContent> further;
  const RayCaster* scene = nullptr;  ///< what has been scanned: throws shadows, carries draped content
  WarpOptions warp;
  int threads = 2;
};

/// The same set, byte for byte, with any number of threads. Maps lie in the order of stations, then further content.
/// Errors: those of bake_steering(), station_command() and bake_warp(), of the first station that has one; kBadValue
/// and kNotFinite of the request; kTableDamaged (two stations of one name).
Result<proto::lut::LutSet> bake_lut_set(const model::SteeredProjector& projector, const LutSetRequest& request);

}  // namespace raysteer::calib::bake
