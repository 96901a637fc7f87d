// Codes that two cameras saw, or one and the projector, become matches.
#pragma once

#include <vector>

#include "calib/scene/match.hpp"
#include "hal/base/result.hpp"
#include "host/scan/decode_look.hpp"

namespace raysteer::host::scan {

struct MatchedLook {
  calib::scene::Matches matches;
  int spacing = 1;  ///< of the nodes, projector px
};

/// One camera is matched with the projector itself. The looks' codes are dropped as soon as they are used, since they
/// are large. Errors: those of calib::scene::locate.
Result<MatchedLook> match_look(std::vector<DecodedLook>& cameras, int panel_width, int panel_height);

}  // namespace raysteer::host::scan
