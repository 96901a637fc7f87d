// bound to one thread: keeps virtual time from running ahead of the wall clock,
// for people who watch.
#pragma once

#include <chrono>
#include <thread>

#include "hal/base/time.hpp"

namespace raysteer::sim::rig {

class Pace {
 public:
  explicit Pace(RigTime begin) : rig_(begin), wall_(std::chrono::steady_clock::now()) {}
  /// Sleeps until the wall clock has come as far as `now`. Behind, it does not
  /// hurry.
  void wait(RigTime now) const { std::this_thread::sleep_until(wall_ + (now - rig_)); }

 private:
  RigTime rig_;
  std::chrono::steady_clock::time_point wall_;
};

}  // namespace raysteer::sim::rig
