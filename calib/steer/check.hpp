// Is what a solve was given fit to be solved at all?
#pragma once

#include "calib/steer/drawing.hpp"
#include "calib/steer/observations.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::steer {

/// kNotFinite, kBadValue (covariances, tolerances, cameras' covariance), kCameraCount, kTooFewLooks (< 6 looks, < 4
/// distinct levels of an axis), kTooFewCorrespondences, kFeedbackDisagrees. The note names look and number.
Status check(const Observations& observations, const Drawing& drawing);

/// kNotFinite, kBadValue, kTooFewCorrespondences of one look.
Status check(const Look& look);

}  // namespace raysteer::calib::steer
