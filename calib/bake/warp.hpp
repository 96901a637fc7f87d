// pure: the warp map of one station, made from its exact pixels and checked against every one of them.
#pragma once

#include "calib/bake/lit_content.hpp"
#include "proto/lut/warp_map.hpp"

namespace raysteer::calib::bake {

struct WarpOptions {
  LightOptions light{};
  double bound_px = 0.05;     ///< of content coordinates, content pixels
  double gain_bound = 0.005;  ///< of gains, as a part of 1
  /// Bright places are dimmed until all are as bright as the darkest, but none to less than 1 / boost of its light.
  /// 1: no gain.
  double boost = 2;
};

/// Cells as large as the bound allows: the largest of which none must be dense, or else the size with the fewest bytes.
/// Every lit pixel is looked up as the device will and compared with `view`, so the stated bound holds at each of them.
/// Errors: kStationOutOfReach (no pixel lights the content), kTableBound (finer than fixed point), kBadValue.
Result<proto::lut::WarpMap> bake_warp(const StationView& view, const PanelRays& rays,
                                      const Eigen::Vector2d& command_rad, const WarpOptions& options);

}  // namespace raysteer::calib::bake
