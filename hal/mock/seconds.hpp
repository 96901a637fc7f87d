// pure: instants and durations as seconds, for formulas.
#pragma once

#include <cmath>

#include "hal/base/time.hpp"

namespace raysteer::hal::mock {

inline double seconds(std::chrono::nanoseconds duration) { return 1e-9 * static_cast<double>(duration.count()); }
inline double seconds(RigTime at) { return seconds(at.time_since_epoch()); }
/// Rounded to the nanosecond.
inline std::chrono::nanoseconds duration(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::chrono::nanoseconds::rep>(std::llround(1e9 * seconds)));
}

}  // namespace raysteer::hal::mock
