// shared: the loop of switches, and the watchdog, that must agree before light is on.
#pragma once

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/clock.hpp"

namespace raysteer::hal {

struct InterlockState {
  bool closed = false;  ///< every switch closed, watchdog fed, not tripped
  RigTime since{};      ///< when `closed` last changed
};

/// Contract. Opening cuts the light in hardware; this object only learns of it.
class Interlock {
 public:
  Interlock() = default;
  Interlock(const Interlock&) = delete;
  Interlock& operator=(const Interlock&) = delete;
  virtual ~Interlock() = default;

  /// Any thread; never blocks. kDeviceUnavailable: the loop cannot be read, which counts as open.
  Result<InterlockState> state();

  /// Feeds the watchdog: "the software is alive". Not fed in time, the loop opens by itself until reset().
  /// kDeviceUnavailable; kInterlockTripped: tripped, feeding no longer helps.
  Status feed();

  /// Opens the loop, now, until a person closes it with reset(). Cannot fail: a back end that cannot open its loop in
  /// software stops feeding its watchdog instead.
  void trip();
  bool tripped() const { return tripped_; }

  /// A person's doing: forgets a trip. kInterlockOpen: a switch is open; close it first. kDeviceUnavailable.
  Status reset();

 private:
  virtual Result<InterlockState> do_state() = 0;
  virtual Status do_feed() = 0;
  virtual void do_trip() = 0;
  virtual Status do_reset() = 0;

  bool tripped_ = false;
};

}  // namespace raysteer::hal
