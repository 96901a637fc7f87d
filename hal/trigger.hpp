// bound to capture: the line that makes both cameras expose at once.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/time.hpp"
#include "hal/clock.hpp"

namespace raysteer::hal {

enum class TriggerSource {
  kFired,     ///< fire() makes the edges
  kExternal,  ///< a trigger-master projector makes them; this line only counts and stamps
};

/// One active edge as the line's input saw it. Numbers count from arm(), without gaps of ours: an edge the line missed
/// has none.
struct TriggerEdge {
  std::uint64_t number = 0;
  RigTime stamp{};
};

/// Contract. Disarmed at first: no edge reaches a camera.
class Trigger {
 public:
  explicit Trigger(const Clock& clock) : clock_(clock) {}
  Trigger(const Trigger&) = delete;
  Trigger& operator=(const Trigger&) = delete;
  virtual ~Trigger() = default;

  /// Lets edges through, counts from zero, and forgets what was scheduled or not yet read. kDeviceUnavailable.
  Status arm(TriggerSource source);
  /// Lets nothing through. Harmless when disarmed. kDeviceUnavailable.
  Status disarm();
  bool armed() const { return armed_; }

  /// Schedules one edge at `at`; several may be scheduled. Never blocks.
  /// kNotArmed: disarmed, or armed for an external source; kTooLate: `at` has passed, by how much; kDeviceUnavailable.
  Status fire(RigTime at);

  /// Edges seen since arm(). kNotArmed, kDeviceUnavailable.
  Result<std::uint64_t> count();

  /// The edges not yet read, oldest first; at least the newest 1024 are kept. Never blocks. kNotArmed,
  /// kDeviceUnavailable.
  Result<std::vector<TriggerEdge>> edges();

 private:
  Status check_armed() const;

  virtual Status do_arm(TriggerSource source) = 0;
  virtual Status do_disarm() = 0;
  virtual Status do_fire(RigTime at) = 0;
  virtual Result<std::uint64_t> do_count() = 0;
  virtual Result<std::vector<TriggerEdge>> do_edges() = 0;

  const Clock& clock_;
  TriggerSource source_ = TriggerSource::kFired;
  bool armed_ = false;
};

}  // namespace raysteer::hal
