#include "hal/late.hpp"

#include <cstdio>

namespace raysteer::hal {

Status check_in_time(const char* what, RigTime at, RigTime now) {
  if (at >= now) {
    return ok();
  }
  const std::chrono::nanoseconds late = now - at;
  char note[80];
  std::snprintf(note, sizeof note, "%s came %.3f ms after its instant", what, 1e-6 * static_cast<double>(late.count()));
  return fail(RCode::kTooLate, note, late.count());
}

}  // namespace raysteer::hal
