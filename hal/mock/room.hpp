// value: what warms up: the room, and each device by itself. Everything is counted from rig time 0.
#pragma once

#include <cmath>
#include <numbers>

namespace raysteer::hal::mock {

/// The room's temperature as it departs from that at rig time 0.
struct Room {
  double trend_k_per_h = 0;
  double swing_k = 0;      ///< amplitude of the heating's cycle
  double cycle_s = 1'800;  ///< period of the heating's cycle

  double kelvin(double t_s) const {
    return trend_k_per_h * t_s / 3'600 + swing_k * std::sin(2 * std::numbers::pi * t_s / cycle_s);
  }
};

/// A device that was switched on `on_before_s` before rig time 0 and approaches its end exponentially.
struct WarmUp {
  double time_constant_s = 600;
  double on_before_s = 1'800;

  /// What has happened since rig time 0, as part of the whole way from cold to warm.
  double since_start(double t_s) const {
    return std::exp(-on_before_s / time_constant_s) - std::exp(-(on_before_s + t_s) / time_constant_s);
  }
};

}  // namespace raysteer::hal::mock
