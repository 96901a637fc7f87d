// bound to capture: the second ability of a trigger-master projector (as a DLPC350).
#pragma once

#include <chrono>
#include <cstdint>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/projector.hpp"

namespace raysteer::hal {

/// Which of the loaded patterns to step through, and how fast.
struct PatternRun {
  int first = 0;
  int count = 0;
  std::chrono::microseconds exposure{};  ///< each pattern is lit for so long
  std::chrono::microseconds period{};    ///< and the next begins so long after the last
};

struct PlayerState {
  bool playing = false;
  int done = 0;  ///< patterns of the present or last run whose exposure has ended
};

/// Contract. Steps through stored patterns by itself; its trigger output pulses at the beginning of each exposure, so
/// that cameras need no software in between. A display projector does not have it: there, whoever captures shows a
/// pattern with Projector::show() and fires Trigger after the measured latency.
class PatternPlayer {
 public:
  /// `projector` is the same device's other face: it knows what is loaded.
  explicit PatternPlayer(Projector& projector) : projector_(projector) {}
  PatternPlayer(const PatternPlayer&) = delete;
  PatternPlayer& operator=(const PatternPlayer&) = delete;
  virtual ~PatternPlayer() = default;

  /// Shortest exposure and shortest gap (period - exposure) the device can do.
  virtual std::chrono::microseconds least_exposure() const = 0;
  virtual std::chrono::microseconds least_gap() const = 0;

  /// Trigger output on or off; off at first. kDeviceUnavailable; kProjectorBusy: a run is playing.
  Status trigger_output(bool on);

  /// Begins a run; afterwards the panel is dark. Never blocks.
  /// kNothingStored: patterns outside the loaded sequence; kBadValue: exposure or gap too short;
  /// kProjectorBusy: a run is playing; kDeviceUnavailable.
  Status play(const PatternRun& run);

  /// Ends a run at once; harmless without one. kDeviceUnavailable.
  Status stop() { return do_stop(); }

  /// Never blocks. kDeviceUnavailable.
  Result<PlayerState> state() { return do_state(); }

 private:
  Status refuse_while_playing();

  virtual Status do_trigger_output(bool on) = 0;
  virtual Status do_play(const PatternRun& run) = 0;
  virtual Status do_stop() = 0;
  virtual Result<PlayerState> do_state() = 0;

  Projector& projector_;
};

}  // namespace raysteer::hal
