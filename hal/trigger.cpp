#include "hal/trigger.hpp"

#include "hal/late.hpp"

namespace raysteer::hal {

Status Trigger::arm(TriggerSource source) {
  armed_ = false;  // a line that fails to arm is not armed
  RAYSTEER_TRY(do_arm(source));
  source_ = source;
  armed_ = true;
  return ok();
}

Status Trigger::disarm() {
  RAYSTEER_TRY(do_disarm());
  armed_ = false;
  return ok();
}

Status Trigger::fire(RigTime at) {
  RAYSTEER_TRY(check_armed());
  if (source_ != TriggerSource::kFired) {
    return fail(RCode::kNotArmed, "armed to count an external source's edges, not to fire");
  }
  RAYSTEER_TRY(check_in_time("fire", at, clock_.now()));
  return do_fire(at);
}

Result<std::uint64_t> Trigger::count() {
  RAYSTEER_TRY(check_armed());
  return do_count();
}

Result<std::vector<TriggerEdge>> Trigger::edges() {
  RAYSTEER_TRY(check_armed());
  return do_edges();
}

Status Trigger::check_armed() const {
  return armed_ ? ok() : Status(fail(RCode::kNotArmed, "the trigger is disarmed"));
}

}  // namespace raysteer::hal
