// All looks of a session become one surface in the rig's frame: decoded, matched, triangulated by both eyes, fused.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calib/scene/fuse.hpp"
#include "calib/steer/solve.hpp"
#include "hal/base/result.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

/// One look of a scanned surface.
struct ScannedLook {
  std::string name;
  std::size_t matched = 0;      ///< nodes of the panel that both eyes saw
  double decoded_fraction = 0;  ///< of the cameras' pixels, mean of both
  /// Between the panel pixels that lit the points and those that the rig's model says would at the look's command:
  /// median, px; and that over its one-sigma uncertainty. Nothing for a look without a command.
  std::optional<double> light_off_px;
  double light_off_sigma = 0;
};

struct ScannedSurface {
  calib::scene::FusedSurface fused;
  std::vector<ScannedLook> looks;  ///< in the order of fused.looks
  std::vector<MissedLook> missed;
};

struct ScanSurfaceOptions {
  std::vector<std::string> looks;    ///< by name; empty: all
  std::vector<std::string> without;  ///< by name
};

/// The two eyes alone make the surface: the mirror's repeatability is worth more depth than the panel adds. The model
/// is only asked whether each look's light came from where its command says. Errors: kCameraCount,
/// kCalibrationMismatch, kUsage (no such look), those of calib::scene::locate, kTooFewMatches, kSurfacesApart,
/// kTooFewLooks (none decoded), kCancelled; a look that cannot be decoded is only missed.
Result<ScannedSurface> scan_surface(const session::Session& session, const calib::steer::Solution& rig,
                                    const ScanSurfaceOptions& options = {}, const Tick& tick = {});

}  // namespace raysteer::host::rig
