// value: is a session what it says it is? Every frame read once; nothing decoded to coordinates.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "calib/decode/sequence_check.hpp"
#include "hal/base/result.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::session {

/// What one camera saw of one look.
struct LookCheck {
  std::string camera;
  std::string look;
  calib::decode::SequenceReport report;
};

struct CheckReport {
  int frames = 0;  ///< read in all
  std::vector<LookCheck> looks;
  std::vector<Error> faults;    ///< each names camera and look; empty: the session is good
  std::vector<Error> warnings;  ///< what can be lived with
  bool good() const { return faults.empty(); }
};

/// Called from one thread at a time with the number of frames done. False: stop; the report then lacks looks.
using Progress = std::function<bool(int done, int total)>;

/// Reads every frame (two threads) and judges each look of each camera. Frames that cannot be read are faults too.
CheckReport check_session(const Session& session, const Progress& progress = {});

/// The same for one look of one camera, as an error: what calibrate and scan call when they do not stream frames
/// through a SequenceCheck themselves.
Status check_look(const Session& session, int camera, int look);

}  // namespace raysteer::host::session
