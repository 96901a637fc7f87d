#include "hal/mirror.hpp"

#include <cmath>
#include <cstdio>

#include "hal/late.hpp"

namespace raysteer::hal {
namespace {

/// Nothing, or why `angle` may not be commanded. A NaN fails every comparison, so it is asked to be inside.
std::optional<Error> outside(const char* axis, Radians angle, Radians least, Radians most) {
  if (angle >= least && angle <= most) {
    return std::nullopt;
  }
  char note[120];
  std::snprintf(note, sizeof note, "%s asked to %.3f mrad, the board allows %.3f to %.3f mrad", axis, 1e3 * angle.raw(),
                1e3 * least.raw(), 1e3 * most.raw());
  return fail(RCode::kMirrorOutOfRange, note);
}

bool finite(Radians angle) { return std::isfinite(angle.raw()); }

}  // namespace

Mirror::Mirror(const Clock& clock, MirrorLimits limits, SettleRule rule) : clock_(clock), limits_(limits), rule_(rule) {
  RAYSTEER_CHECK(limits.least.axis1 <= limits.most.axis1 && limits.least.axis2 <= limits.most.axis2);
  RAYSTEER_CHECK(rule.tolerance.raw() > 0 && rule.window.count() >= 0);
}

Status Mirror::aim(MirrorAngles target, RigTime at) {
  if (auto error = outside("axis 1", target.axis1, limits_.least.axis1, limits_.most.axis1)) {
    return *error;
  }
  if (auto error = outside("axis 2", target.axis2, limits_.least.axis2, limits_.most.axis2)) {
    return *error;
  }
  RAYSTEER_TRY(check_in_time("aim", at, clock_.now()));
  RAYSTEER_TRY(do_aim(target, at));
  commanded_ = target;
  command_begins_ = at;
  quiet_since_.reset();
  return ok();
}

Result<MirrorReading> Mirror::feedback() {
  Result<MirrorReading> reading = do_feedback();
  if (reading && !(finite(reading->angles.axis1) && finite(reading->angles.axis2))) {
    return fail(RCode::kMirrorSensor, "expected an angle, the sensor gave no number");
  }
  return reading;
}

Result<bool> Mirror::settled() {
  Result<MirrorReading> reading = feedback();
  if (!reading) {
    quiet_since_.reset();
    return std::move(reading).error();
  }
  if (!commanded_ || clock_.now() < command_begins_ || reading->stamp < command_begins_) {
    return false;
  }
  const auto near = [&](Radians is, Radians wanted) { return std::abs((is - wanted).raw()) <= rule_.tolerance.raw(); };
  if (!near(reading->angles.axis1, commanded_->axis1) || !near(reading->angles.axis2, commanded_->axis2)) {
    quiet_since_.reset();
    return false;
  }
  if (!quiet_since_) {
    quiet_since_ = reading->stamp;
  }
  return reading->stamp - *quiet_since_ >= rule_.window;
}

}  // namespace raysteer::hal
