#include "hal/mock/mock_interlock.hpp"

namespace raysteer::hal::mock {

MockInterlock::MockInterlock(const Clock& clock, const InterlockParameters& parameters, Faults faults)
    : clock_(clock), parameters_(parameters), faults_(std::move(faults)) {}

bool MockInterlock::switch_is_open(RigTime at) const {
  return switch_open_ || faults_.lasting("open", at) || faults_.lasting("flap", at);
}

void MockInterlock::update(RigTime now) {
  const bool closed = !switch_is_open(now) && !latched_;
  if (closed != closed_.last()) {
    closed_.set(now, closed);
  }
}

void MockInterlock::advance(RigTime now) {
  if (parameters_.watchdog.count() > 0 && !latched_ && now - fed_ >= parameters_.watchdog) {
    update(fed_ + parameters_.watchdog);
    latched_ = true;
    update(fed_ + parameters_.watchdog);
  }
  update(now);
  closed_.forget(now - std::chrono::seconds(10));
}

std::optional<RigTime> MockInterlock::first_open(RigTime from, RigTime until) const {
  if (!closed_.at(from)) {
    return from;
  }
  const RigTime change = closed_.next_change(from);
  return change <= until ? std::optional(change) : std::nullopt;
}

Status MockInterlock::check_plugged() const {
  return faults_.lasting("unplug", clock_.now()) ? Status(fail(RCode::kDeviceUnavailable, "the interlock's loop"))
                                                 : ok();
}

Result<InterlockState> MockInterlock::do_state() {
  RAYSTEER_TRY(check_plugged());
  return InterlockState{.closed = closed_.last(), .since = closed_.last_change()};
}

Status MockInterlock::do_feed() {
  RAYSTEER_TRY(check_plugged());
  if (latched_) {
    return fail(RCode::kInterlockTripped, "the watchdog was not fed in time");
  }
  fed_ = clock_.now();
  return ok();
}

void MockInterlock::do_trip() {
  latched_ = true;
  update(clock_.now());
}

Status MockInterlock::do_reset() {
  RAYSTEER_TRY(check_plugged());
  if (switch_is_open(clock_.now())) {
    return fail(RCode::kInterlockOpen, "a switch is open; close it before the reset");
  }
  latched_ = false;
  fed_ = clock_.now();
  update(clock_.now());
  return ok();
}

}  // namespace raysteer::hal::mock
