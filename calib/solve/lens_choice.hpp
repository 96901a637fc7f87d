// Which lens model? The one that predicts corners it has not seen. Inside calib/solve.
#pragma once

#include <vector>

#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

/// Tries BC4, BC5 and BC8 on camera `device`: views are left out in turn, their poses fitted to every second corner,
/// and the others are predicted. BC5 must be 3 % better than BC4, BC8 10 % better than both, and monotonic. `alone`
/// (the camera by itself) comes back with the chosen model; `trials` gets a row each. Errors: kSolverDiverged.
Status choose_lens(const Observations& observations, std::size_t device, State& alone, std::vector<LensTrial>& trials);

}  // namespace raysteer::calib::solve
