// Why datums do not fit their survey: what was tried, and what fits best. Inside calib/datum only.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/datum/fit.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::datum {

/// The error that explains why `rigid` does not fit: kScaleWrong, kDatumsExchanged or kDatumMoved, with names and
/// millimetres. Nothing when what is wrong is less than a millimetre and two per mille: then stated sigmas are too
/// small, no more. `try_scale` is false where the survey's own scale is the rig's.
std::optional<Error> explain(const Pairs& pairs, const std::vector<std::string>& names, const Fit& rigid,
                             bool try_scale);

/// Is a scale wrong enough to say so? 4 sigma and two per mille.
bool is_wrong(double scale, double sigma);
/// "measured 1002.1 mm where the survey has 1000.0 mm (+0.21 %, +-0.02 %)"
std::string scale_note(double measured_m, double known_m, double sigma_m);

}  // namespace raysteer::calib::datum
