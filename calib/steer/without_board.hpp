// The steered rig without any board: cameras known only as the board file draws them.
//
// A mirror that moves makes this well posed where the scene has relief (algorithms 5.3): projector, mirror and cameras
// come out together. What no picture can tell is how long a metre is, so one length has to be known; without one the
// drawn distance between the eyes has to serve, as far as its tolerance goes.
#pragma once

#include <array>
#include <optional>

#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {

/// `drawn` (left, right) with the drawing's tolerances as covariance.
model::Rig drawn_cameras(const model::Rig& drawn, const Tolerance& tolerance);

/// One length that somebody measured.
struct KnownLength {
  double metres = 0;
  double sigma_m = 0;
  /// Between two places that both eyes saw (LitPoint::x is not used); no value: between the two eyes.
  std::optional<std::array<LitPoint, 2>> ends;
  /// How far what was seen of an end may be off the place itself, one standard deviation: the middle of a round datum's
  /// ellipse is not its centre's picture, by a tenth of a pixel for discs of 0.1 m.
  double ends_off_px = 0.1;
};

/// `drawn`: its cameras have no covariance yet. Errors: those of solve(), kNotFinite and kBadValue (the length),
/// kTooFewCorrespondences (an end of it that the eyes do not see), and those of check_depth() (calib/steer/depth.hpp),
/// by which a solve that found no answer is explained too.
Result<Solution> solve_without_board(const Observations& drawn, const Drawing& drawing,
                                     const std::optional<KnownLength>& known, const Options& options = {});

}  // namespace raysteer::calib::steer
