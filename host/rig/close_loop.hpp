// The loop closed at stations: a handful of dots says where the mirror truly stands, and whether it drifted.
//
// A mirror errs in two ways. What it repeats (it was knocked, it warmed up) dots measure once, and predictions hold
// until it changes again. What is new at each aim (its repeatability) dots measure for as long as the mirror stands
// still.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/steer/observations.hpp"
#include "calib/steer/refine.hpp"
#include "hal/base/result.hpp"
#include "host/rig/aimed_rig.hpp"
#include "host/rig/gather.hpp"
#include "host/rig/stations.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::rig {

inline constexpr int kDots = 20;

/// At most `count` of a look's points, spread over the panel, as dots seen by the solved cameras.
std::vector<calib::steer::Dot> dots_of(const calib::steer::Solution& solution, const calib::steer::Look& look,
                                       int count = kDots);

/// The bound to expect at a station once the loop is closed there, from the drawing of 20 dots on its plane, each seen
/// with 0.1 px: no light is shown. Infinite where the cameras see fewer than 4 of them.
double closed_loop_95_mm(const calib::steer::InRoom& rig, const AimedStation& station);

struct ClosedLoop {
  std::optional<calib::steer::Drift> drift;  ///< when the looks say surely that there is one; all stations follow it
  std::vector<std::string> not_looked_at;    ///< stations that need it, and the session has no look at them
};

/// First the drift since the calibration, from all looks; then each station whose bound exceeds its tolerance is
/// refined by its own look, if there is one. `looks` in the order they were taken. Errors: those of refine_look(),
/// named after the look; kTooFewLooks (none).
Result<ClosedLoop> close_loop(const calib::steer::InRoom& rig, std::span<const calib::steer::Look> looks,
                              std::vector<AimedStation>& stations);

/// The same by a session's looks. Errors: also those of Session::open() and gather(); kTooFewLooks when a look that was
/// asked for could not be decoded.
Result<ClosedLoop> close_loop_by(const session::Session& session, AimedRig& rig, const Tick& tick = {});

/// Does the light lie within the tolerance: now, and where the mirror does not stand any more, once it is aimed again.
bool holds(const AimedStation& station);

}  // namespace raysteer::host::rig
