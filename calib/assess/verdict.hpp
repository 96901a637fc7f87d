// From numbers to words. Inside calib/assess and its tests.
#pragma once

#include "calib/assess/assessment.hpp"
#include "calib/solve/solution.hpp"

namespace raysteer::calib::assess {

/// Fills verdict, summary, reasons and advice from the rest of `assessment`.
void judge(const solve::Solution& solution, Assessment& assessment);

}  // namespace raysteer::calib::assess
