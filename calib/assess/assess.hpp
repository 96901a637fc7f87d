// Judges a solution: cross-validation, uncertainty, coverage, and a verdict in words with what to add.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "calib/assess/assessment.hpp"
#include "calib/model/rig.hpp"
#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::assess {

struct AssessOptions {
  const model::Rig* previous = nullptr;  ///< an earlier calibration to compare with
  int folds = 7;                         ///< of the cross-validation; with fewer views, as many as there are
  /// Told what is being done and how far it is, 0 to 1.
  std::function<void(std::string_view stage, double done)> progress;
};

/// `observations` are those the solution came from. Errors: those of the solver when views are left out.
Result<Assessment> assess(const solve::Observations& observations, const solve::Solution& solution,
                          const AssessOptions& options = {});

}  // namespace raysteer::calib::assess
