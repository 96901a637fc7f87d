#include "hal/mock/manual_clock.hpp"

namespace raysteer::hal::mock {

void ManualClock::advance_to(RigTime now) {
  if (now.time_since_epoch().count() > now_.load()) {
    now_.store(now.time_since_epoch().count());
  }
}

}  // namespace raysteer::hal::mock
