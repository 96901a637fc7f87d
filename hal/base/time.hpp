// value: two kinds of instant that do not subtract. RigTime is our clock, CameraTime is the camera's own.
#pragma once

#include <chrono>

namespace raysteer {

/// A clock that nobody can ask for the time: `now` is always an argument.
template <class Tag>
struct InstantClock {
  using duration = std::chrono::nanoseconds;
  using rep = duration::rep;
  using period = duration::period;
  using time_point = std::chrono::time_point<InstantClock>;
  static constexpr bool is_steady = true;
};

using RigTime = InstantClock<struct RigClockTag>::time_point;
using CameraTime = InstantClock<struct CameraClockTag>::time_point;

}  // namespace raysteer
