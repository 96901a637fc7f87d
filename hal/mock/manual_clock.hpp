// shared: a clock that stands still until it is told.
#pragma once

#include <atomic>

#include "hal/clock.hpp"

namespace raysteer::hal::mock {

class ManualClock final : public Clock {
 public:
  /// It is `now`. An earlier instant changes nothing: rig time never goes back.
  void advance_to(RigTime now);

  /// What the wall clock says is somebody else's business: it may step, and rig time does not notice.
  std::chrono::nanoseconds wall_offset() const { return wall_offset_; }
  void step_wall_clock(std::chrono::nanoseconds by) { wall_offset_ += by; }

 private:
  RigTime do_now() const override { return RigTime(std::chrono::nanoseconds(now_.load())); }

  std::atomic<std::chrono::nanoseconds::rep> now_{0};
  std::chrono::nanoseconds wall_offset_{0};
};

}  // namespace raysteer::hal::mock
