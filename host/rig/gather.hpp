// A session's looks become what the steered rig is solved from: decoded, matched, thinned out.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/steer/observations.hpp"
#include "hal/base/result.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

/// Called now and then with the part done (0 to 1). False: stop; the work then returns kCancelled.
using Tick = std::function<bool(double done)>;

/// A look of which nothing could be used.
struct MissedLook {
  std::string name;
  Error error;
};

struct Gathered {
  calib::steer::Observations observations;
  std::vector<MissedLook> missed;
};

struct GatherOptions {
  /// Points of a look: the best of each cell of a grid over the panel. Many more do not help, since the mirror's
  /// repeatability outweighs their noise (algorithms 4.8).
  int columns = 24;
  int rows = 16;
  std::vector<std::string> looks;  ///< by name, in this order; empty: all
};

/// Are these the session's two cameras, in its order? Errors: kCameraCount, kCalibrationMismatch.
Status check_cameras(const session::Session& session, const calib::model::Rig& cameras);

/// `cameras`: calibrated, two devices named as the session's cameras are. Errors: kCameraCount, kCalibrationMismatch,
/// kCommandMissing, kBadSequence (one axis is missing), kTooFewLooks (nothing decoded), kCancelled; a look that cannot
/// be decoded is only missed.
Result<Gathered> gather(const session::Session& session, const calib::model::Rig& cameras,
                        const GatherOptions& options = {}, const Tick& tick = {});

}  // namespace raysteer::host::rig
