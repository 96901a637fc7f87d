// Where light really lands at stations: measured at looks that show them, against where it was wanted.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "calib/steer/observations.hpp"
#include "hal/base/result.hpp"
#include "host/rig/stations.hpp"

namespace raysteer::host::rig {

struct VerifiedStation {
  std::string name;
  std::array<double, 4> corner_mm{};  ///< each corner's distance from where it was wanted
  std::array<double, 4> sure_mm{};    ///< 95 % of what the measurement itself is off by is below this
  /// Measured minus wanted, along the picture's x (right) and y (down).
  std::array<Eigen::Vector2d, 4> off_mm{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(),
                                        Eigen::Vector2d::Zero()};
  double error_mm = 0;     ///< the worst corner's
  double bound_95_mm = 0;  ///< the worst of corner_mm + sure_mm: the corner is not off by more, 95 % sure
  /// Of a picture that is looked at (on the scanned surface, or from an eye): 95 % of its measured points are off by
  /// less than this, their own noise included.
  double picture_95_mm = 0;
  std::size_t points = 0;  ///< that say so; 0 for a station to scale

  /// Within a tolerance, 95 % sure; 0 asks for none.
  bool within(double tolerance_mm) const { return tolerance_mm <= 0 || bound_95_mm <= tolerance_mm; }
};

/// Where the panel pixels of the station's corners land. The rig's own cameras and datums are the measure.
///
/// To scale: by a quadratic through the points measured around each corner (measured_pixel.hpp), along the surface.
/// Looked at: each measured point should show the piece of the picture that belongs where the eyes see it; how far that
/// piece is from the one its panel pixel was baked for counts across the way it is looked at, in the middle of the
/// points nearest to the corner. Errors: kTooFewCorrespondences (fewer than 12 points of the station).
Result<VerifiedStation> verify_station(const calib::steer::InRoom& rig, const AimedStation& station,
                                       const calib::steer::Look& look, const Scene* scene = nullptr);

/// The look at a station's command, or nothing.
const calib::steer::Look* look_at(std::span<const calib::steer::Look> looks, const AimedStation& station);

}  // namespace raysteer::host::rig
