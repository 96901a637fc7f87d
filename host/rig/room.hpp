// A solved rig tied to its room: datums found in the looks' dark frames, compared with their survey.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calib/datum/measure.hpp"
#include "calib/datum/tie.hpp"
#include "calib/steer/room.hpp"
#include "hal/base/result.hpp"
#include "host/rig/gather.hpp"
#include "host/session/session.hpp"
#include "proto/survey/survey.hpp"

namespace raysteer::host::rig {

/// The rig stands still: so many looks at its datums are enough.
inline constexpr int kDatumLooks = 8;

/// The datums that both eyes see in the black frames of at most `most_looks` looks, evenly spread over the session from
/// its first look to its last. Errors: kCameraCount; kBadSequence (no black frame); those of Session::load; kRigMoved
/// (they are not where other looks show them); kCancelled.
Result<std::vector<calib::datum::View>> see_datums(const session::Session& session, int most_looks = 8,
                                                   const Tick& tick = {});

struct InRoom {
  calib::steer::InRoom rig;
  calib::datum::Tie tie;  ///< by the cameras alone: each datum's miss, the lengths, the scale
};

/// Errors: those of both calib's tie_to_room.
Result<InRoom> tie_to_room(const calib::steer::Solution& solution, const proto::survey::Survey& survey,
                           const std::vector<calib::datum::View>& views);

}  // namespace raysteer::host::rig
