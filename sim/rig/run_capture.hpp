// bound to the caller's thread: firmware/capture on the pretend rig: ticks the
// engine, advances time, and is the person who prepares looks.
#pragma once

#include <functional>

#include "firmware/capture/capture.hpp"
#include "sim/rig/pretend_rig.hpp"

namespace raysteer::sim::rig {

struct RunOptions {
  bool paced = false;  ///< not faster than the wall clock
  /// Called some times a virtual second with the engine's own figures; false:
  /// stop, kCancelled.
  std::function<bool(const firmware::capture::Progress&)> progress;
};

/// Runs a plan to its end. Errors: those of the engine and the sink;
/// kBadPrepare, before anything moves; kCancelled.
Result<firmware::capture::Findings> run_capture(PretendRig& rig, const proto::plan::Plan& plan,
                                                const PatternSequence& sequence, firmware::capture::Options options,
                                                firmware::capture::Sink& sink, const EventLog& log,
                                                const RunOptions& run);

}  // namespace raysteer::sim::rig
