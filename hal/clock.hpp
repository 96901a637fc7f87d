// shared: the rig's clock.
#pragma once

#include "hal/base/time.hpp"

namespace raysteer::hal {

/// Contract. The only place that time comes from; whoever needs it is given a Clock, or better, an instant.
class Clock {
 public:
  Clock() = default;
  Clock(const Clock&) = delete;
  Clock& operator=(const Clock&) = delete;
  virtual ~Clock() = default;

  /// Now. Any thread; never blocks; never goes back, whatever the wall clock does.
  RigTime now() const { return do_now(); }

 private:
  virtual RigTime do_now() const = 0;
};

}  // namespace raysteer::hal
