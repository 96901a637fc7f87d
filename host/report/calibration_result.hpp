// Makes a calibration's result from what solve and assess found.
#pragma once

#include <string>

#include "calib/assess/assessment.hpp"
#include "calib/solve/solution.hpp"
#include "hal/base/target.hpp"
#include "host/report/result.hpp"

namespace raysteer::host::report {

/// `session` is the path as the user gave it; `calibration_id` that of calibration.toml.
CalibrationResult calibration_result(const calib::solve::Solution& solution,
                                     const calib::assess::Assessment& assessment, const TargetSpec& target,
                                     std::string session, std::string calibration_id);

/// "chessboard, 9 x 6 corners of 30 mm"
std::string describe(const TargetSpec& target);

}  // namespace raysteer::host::report
