// A session's frames become what calib/solve starts from: boards found, projector codes decoded.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "calib/target/target_geometry.hpp"
#include "hal/base/result.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::calibrate {

/// Called now and then with the part done (0 to 1). False: stop; the work then returns kCancelled.
using Tick = std::function<bool(double done)>;

/// A view in which a camera found no board, or the projector too little of it.
struct MissedView {
  int view = 0;    ///< index into Observations::views
  int device = 0;  ///< index into Observations::devices
  Error error;
};

struct Gathered {
  calib::solve::Observations observations;  ///< target.layout is the one found
  std::vector<MissedView> missed;
};

/// Board corners of every look that shows the session's target, in every camera, from the evenly lit frame (white, or
/// the first). Errors: kTargetScaleMissing and kMissingKey before any frame is read; kFramesBlack, kFramesSaturated,
/// kTargetNotFound, kWrongTarget, kMirroredTarget when most frames fail; those of Session::load; kCancelled.
Result<Gathered> gather_cameras(const session::Session& session, const Tick& tick = {});

/// The board of one look.
struct BoardInLook {
  TargetSpec target;                                      ///< target.layout is the one found
  std::vector<Result<calib::target::Detection>> cameras;  ///< one a camera: its corners, or why it sees no board
};

/// The target that look number `look` shows, in every camera by itself: one that sees no board fails alone. Errors:
/// kMissingKey (the look shows none), kTargetScaleMissing, those of Session::load, kCancelled.
Result<BoardInLook> find_board(const session::Session& session, int look, const Tick& tick = {});

/// The same as gather_cameras() with the projector as last device: decoded pixels and the panel px of the corners.
/// Errors: also those of decode_look; kTooFewCorrespondences when most looks have too few; kBadSequence when one axis
/// is missing.
Result<Gathered> gather_projector(const session::Session& session, const Tick& tick = {});

/// Says in the solution's views why those were left out in which no board was found.
void explain_missed(const std::vector<MissedView>& missed, calib::solve::Solution& solution);

}  // namespace raysteer::host::calibrate
