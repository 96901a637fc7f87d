// A session's looks become what the steered rig is solved from: decoded, matched, thinned out.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/steer/observations.hpp"
#include "calib/steer/one_eye.hpp"
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
  std::vector<std::string> one_eyed;  ///< looks taken from one eye
};

struct GatherOptions {
  /// Points of a look: the best of each cell of a grid over the panel. Many more do not help, since the mirror's
  /// repeatability outweighs their noise (algorithms 4.8).
  int columns = 24;
  int rows = 16;
  std::vector<std::string> looks;  ///< by name, in this order; empty: all
  bool cameras_drawn = false;      ///< known only as drawn: they cannot say how pixels scatter
  /// Looks of which both eyes do not see enough are taken from one eye, where the light lies on this plane.
  std::optional<calib::steer::KnownPlane> plane{};
  std::string plane_look{};  ///< left out: there a board lies in the light
};

/// Are these the session's two cameras, in its order? Errors: kCameraCount, kCalibrationMismatch.
Status check_cameras(const session::Session& session, const calib::model::Rig& cameras);

/// `cameras`: calibrated, two devices named as the session's cameras are. Errors: kCameraCount, kCalibrationMismatch,
/// kCommandMissing, kBadSequence (one axis is missing), kTooFewLooks (nothing decoded), kCancelled; a look that cannot
/// be decoded is only missed.
Result<Gathered> gather(const session::Session& session, const calib::model::Rig& cameras,
                        const GatherOptions& options = {}, const Tick& tick = {});

}  // namespace raysteer::host::rig
