// value: how a pretend mirror moves, senses and errs. Radians mechanical, seconds, kelvin.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>

#include "hal/base/result.hpp"
#include "hal/mirror.hpp"
#include "hal/mock/room.hpp"

namespace raysteer::hal::mock {

inline constexpr double kUnlimited = std::numeric_limits<double>::infinity();

/// From command to angle, at rest (algorithms 4.5): angle = half_range [(1 + gain) u + quadratic u^2 + cubic u^3 +
/// cross_talk u_other], u = command / half_range. Ideal by default; a rig's truth is drawn outside.
struct CommandCurve {
  double half_range = 0.35;
  double gain = 0;
  double quadratic = 0;
  double cubic = 0;
  double cross_talk = 0;
};

/// Command -> pure delay -> rate and acceleration limit -> second-order loop.
struct AxisDynamics {
  double delay_s = 20e-6;
  double rate = 140;            ///< rad/s
  double acceleration = 1.2e5;  ///< rad/s^2
  double natural = 15'700;      ///< of the loop, undamped, rad/s
  double damping = 0.7;
};

/// What the position sensor makes of the command-side position: (1 + gain) position + offset + noise.
struct AxisSensor {
  double offset = 0;
  double gain = 0;
  double noise = 5e-6;  ///< one standard deviation
  double rail = 1;      ///< beyond +- this the sensor reads nonsense
};

/// What takes the angle from where the curve says, unseen by the sensor.
struct AxisErrors {
  double repeatability = 20e-6;  ///< one standard deviation, drawn anew at each aim
  double hysteresis = 0;         ///< +- this, by the side of approach
  double warm_offset = 100e-6;   ///< offset gained from cold to warm
  double warm_gain = 0;          ///< relative, gained from cold to warm
  double room_offset = 10e-6;    ///< per kelvin of the room
  double room_gain = 50e-6;      ///< relative, per kelvin of the room
};

struct AxisParameters {
  CommandCurve curve;
  AxisDynamics dynamics;
  AxisSensor sensor;
  AxisErrors errors;
  double command_step = 1e-6;  ///< commands are rounded to multiples of this
  double travel = 0.36;        ///< mechanical stops at +- this, on the command side
};

struct MirrorParameters {
  MirrorLimits limits{.least = {Radians(-0.21), Radians(-0.21)}, .most = {Radians(0.21), Radians(0.21)}};
  SettleRule settle;
  std::array<AxisParameters, 2> axes;
  WarmUp warm_up;
  /// Drift moves in steps, so that a world that keeps a traced look need not trace it anew for every nanoradian.
  double drift_step = 0.5e-6;
};

/// "galvo": a large-beam pair, 20 urad. "head": a pan/tilt mirror head, 20 urad; "cheap-head": the same, 200 urad.
/// kBadValue lists the names.
Result<MirrorParameters> mirror_preset(std::string_view name);

}  // namespace raysteer::hal::mock
