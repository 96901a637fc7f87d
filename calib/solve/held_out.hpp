// How well does a calibration predict corners it has not seen?
#pragma once

#include <vector>

#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

/// Root mean square two-dimensional error of held-out corners, px. The views are dealt to `folds` groups that are left
/// out in turn; in a view left out the target's pose is fitted to every second corner (like the black squares of a
/// chessboard, of all devices), and the others are the test. Lengths of the single errors go to `errors` when given.
/// Errors of the solver pass; kTooFewViews when nothing is left to test with.
Result<double> held_out_error(const Measurements& measurements, const State& start, int folds,
                              std::vector<double>* errors = nullptr);

}  // namespace raysteer::calib::solve
