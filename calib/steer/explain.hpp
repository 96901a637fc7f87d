// Nothing fits, or not everything: which simple mistake explains it?
#pragma once

#include <optional>

#include "calib/steer/stages.hpp"

namespace raysteer::calib::steer {

/// The reason as an error: kAxisReversed, kPictureMirrored, kRigMoved, kLookForeign, kDrawingsDisagree, or
/// kRigNotSolved where no single mistake explains it. `best`: what the solve came to.
Error why_not(const Observations& observations, const Drawing& drawing, const Options& options, const Attempt& best);

/// Latent angles scatter much more than the mirror is said to: is it one look (kLookForeign), or a bump (kRigMoved)?
/// No value where they simply scatter.
std::optional<Error> why_scattered(const Observations& observations, const Drawing& drawing, const Options& options,
                                   double repeatability_rad);

}  // namespace raysteer::calib::steer
