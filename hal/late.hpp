// pure: the one rule for commands that carry an instant.
#pragma once

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"

namespace raysteer::hal {

/// kTooLate when `at` has passed; says what came how late, which is also the detail, in nanoseconds.
Status check_in_time(const char* what, RigTime at, RigTime now);

}  // namespace raysteer::hal
