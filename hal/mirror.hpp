// bound to rt: the steered mirror.
#pragma once

#include <chrono>
#include <optional>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/base/units.hpp"
#include "hal/clock.hpp"

namespace raysteer::hal {

/// Mechanical angles. A galvo pair: axis1 turns the mirror that light meets first. A head: axis1 is the outer axis
/// (pan), axis2 the inner one (tilt). Light turns by about twice as much.
struct MirrorAngles {
  Radians axis1;
  Radians axis2;
  bool operator==(const MirrorAngles&) const = default;
};

/// What the board file allows. No back end ever sees a command outside.
struct MirrorLimits {
  MirrorAngles least;
  MirrorAngles most;
};

/// Where the mirror's own sensor saw it.
struct MirrorReading {
  MirrorAngles angles;
  RigTime stamp;
};

/// "Still" means: every reading of the last `window` lies within `tolerance` of the command, on both axes.
struct SettleRule {
  Radians tolerance{100e-6};
  std::chrono::microseconds window{1000};
};

/// Contract. Built with limits and a rule for "settled"; both are checked here, once, for every back end.
class Mirror {
 public:
  Mirror(const Clock& clock, MirrorLimits limits, SettleRule rule);
  Mirror(const Mirror&) = delete;
  Mirror& operator=(const Mirror&) = delete;
  virtual ~Mirror() = default;

  /// Asks for `target` from the instant `at` on; replaces a command that has not begun. Never blocks.
  /// kMirrorOutOfRange: an angle outside limits(), or not a number; says axis, value and limits. The mirror keeps its
  /// previous command. kTooLate: `at` has passed; says by how much. kDeviceUnavailable: the device does not answer.
  Status aim(MirrorAngles target, RigTime at);

  /// The last accepted target; nothing before the first.
  std::optional<MirrorAngles> last_commanded() const { return commanded_; }

  /// The newest reading of the position sensor. Never blocks. kDeviceUnavailable; kMirrorSensor: not a number, or
  /// outside what the sensor can read, which is never passed on as an angle.
  Result<MirrorReading> feedback();

  /// Is it still, where it was told? False before the first command, before the command's instant, and until the
  /// readings have kept to the rule for its whole window. To be asked once a tick. Errors: those of feedback().
  Result<bool> settled();

  const MirrorLimits& limits() const { return limits_; }
  const SettleRule& settle_rule() const { return rule_; }

 private:
  virtual Status do_aim(MirrorAngles target, RigTime at) = 0;
  virtual Result<MirrorReading> do_feedback() = 0;

  const Clock& clock_;
  MirrorLimits limits_;
  SettleRule rule_;
  std::optional<MirrorAngles> commanded_;
  RigTime command_begins_{};
  std::optional<RigTime> quiet_since_;  ///< stamp of the first reading of the present quiet run
};

}  // namespace raysteer::hal
