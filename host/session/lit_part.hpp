// pure: where in a session's frames the light is.
#pragma once

#include "hal/base/region.hpp"
#include "hal/base/result.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::session {

/// calib::decode::lit_region of the look's first white and black; the whole frame where the sequence has no such pair.
/// Errors: those of Session::load.
Result<Region> lit_part(const Session& session, int camera, int look);

}  // namespace raysteer::host::session
