// bound to whoever advances the rig: a loop that opens when told.
#pragma once

#include "hal/interlock.hpp"
#include "hal/mock/fault.hpp"
#include "hal/mock/history.hpp"

namespace raysteer::hal::mock {

struct InterlockParameters {
  /// Not fed for so long, the loop opens until reset(). 0: no watchdog is fitted.
  std::chrono::milliseconds watchdog{0};
};

class MockInterlock final : public Interlock {
 public:
  MockInterlock(const Clock& clock, const InterlockParameters& parameters, Faults faults);

  void advance(RigTime now);

  /// A person opens or closes a switch, now.
  void open() { switch_open_ = true, update(clock_.now()); }
  void close() { switch_open_ = false, update(clock_.now()); }

  /// The first instant in [from, until] at which the loop was not closed: what cuts the light in hardware.
  std::optional<RigTime> first_open(RigTime from, RigTime until) const;

 private:
  Result<InterlockState> do_state() override;
  Status do_feed() override;
  void do_trip() override;
  Status do_reset() override;

  bool switch_is_open(RigTime at) const;
  void update(RigTime now);
  Status check_plugged() const;

  const Clock& clock_;
  InterlockParameters parameters_;
  Faults faults_;
  bool switch_open_ = false;
  bool latched_ = false;  ///< tripped, by software or by the watchdog
  RigTime fed_{};
  History<bool> closed_{true};
};

}  // namespace raysteer::hal::mock
