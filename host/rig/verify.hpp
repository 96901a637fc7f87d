// Where light really lands at stations: measured at looks that show them, against where it was wanted.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calib/steer/observations.hpp"
#include "hal/base/result.hpp"
#include "host/rig/stations.hpp"

namespace raysteer::host::rig {

struct VerifiedStation {
  std::string name;
  std::array<double, 4> corner_mm{};  ///< each corner's distance from where it was wanted, on the surface
  double error_mm = 0;                ///< the worst
};

/// Where the panel pixels of the station's corners land, by a quadratic through the points measured around each. The
/// rig's own cameras and datums are the measure. Errors: kTooFewCorrespondences (fewer than 12 points on the station's
/// plane around a corner).
Result<VerifiedStation> verify_station(const calib::steer::InRoom& rig, const AimedStation& station,
                                       const calib::steer::Look& look);

/// The look at a station's command, or nothing.
const calib::steer::Look* look_at(std::span<const calib::steer::Look> looks, const AimedStation& station);

}  // namespace raysteer::host::rig
