// Do all views belong together? Names those that do not. Inside calib/solve.
#pragma once

#include <vector>

#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

/// Adjusts all devices robustly and marks views that miss the others' calibration; `state` comes back adjusted to those
/// that agree. A few odd views are left out (kForeignView in their ViewFit). Errors: kCameraMovedDuringCapture when the
/// views before and after one of them each agree among themselves; kForeignView when most disagree; kTooFewViews.
Status leave_out_disagreeing_views(const Observations& observations, const std::vector<State>& alone, State& state,
                                   std::vector<ViewFit>& views);

}  // namespace raysteer::calib::solve
