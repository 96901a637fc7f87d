#include "hal/interlock.hpp"

namespace raysteer::hal {

Result<InterlockState> Interlock::state() {
  Result<InterlockState> state = do_state();
  if (state && tripped_) {
    state->closed = false;
  }
  return state;
}

Status Interlock::feed() {
  if (tripped_) {
    return fail(RCode::kInterlockTripped, "feeding the watchdog of a tripped interlock");
  }
  return do_feed();
}

void Interlock::trip() {
  tripped_ = true;
  do_trip();
}

Status Interlock::reset() {
  RAYSTEER_TRY(do_reset());
  tripped_ = false;
  return ok();
}

}  // namespace raysteer::hal
