// First values for an adjustment. Inside calib/solve.
#pragma once

#include <vector>

#include "calib/solve/observations.hpp"
#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

/// Are the observations complete, finite and enough? Errors as solve().
Status check(const Observations& observations);

/// Boards that look the same turned by half a turn may have been read from either end by two cameras. Turns the
/// readings of all cameras but the first so that the cameras stand to each other the same way in every view.
void resolve_half_turns(Observations& observations, const std::vector<State>& alone);

/// Every camera for itself: closed form, then a robust adjustment. Device i of the rig is the only device of state i;
/// views it did not see keep the identity. Projectors get an empty state.
Result<std::vector<State>> solve_alone(const Observations& observations, model::LensModel lens);

/// Largest angle between the target's normals over all views, radians.
double normal_spread(const Observations& observations, const std::vector<State>& alone);

/// All devices in the first camera's frame. `projector_start_px`: as SolveOptions.
Result<State> join(const Observations& observations, const std::vector<State>& alone, double projector_start_px);

/// All corners and pixels of views that are used.
Measurements collect(const Observations& observations, const std::vector<bool>& used);

}  // namespace raysteer::calib::solve
