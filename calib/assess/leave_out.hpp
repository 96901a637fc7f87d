// Solves again without some views. Inside calib/assess.
#pragma once

#include <vector>

#include "calib/assess/assessment.hpp"
#include "calib/model/rig.hpp"
#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::assess {

/// Views left out in turn; see CrossValidation.
Result<CrossValidation> cross_validate(const solve::Observations& observations, const solve::Solution& solution,
                                       int folds);

/// Devices solved from every second used view: the odd ones (0) or the even ones (1). Empty when fewer than three views
/// are left.
Result<std::vector<model::Device>> half_of_the_views(const solve::Observations& observations,
                                                     const solve::Solution& solution, int which);

}  // namespace raysteer::calib::assess
