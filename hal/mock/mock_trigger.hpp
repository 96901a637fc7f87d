// bound to whoever advances the rig: a line whose edges come late, twice or never.
#pragma once

#include <deque>
#include <functional>
#include <vector>

#include "hal/mock/fault.hpp"
#include "hal/trigger.hpp"

namespace raysteer::hal::mock {

struct TriggerParameters {
  double latency_s = 10e-6;  ///< from the instant asked for to the edge
  double jitter_s = 1e-6;    ///< one standard deviation, cut at three
};

class MockTrigger final : public Trigger {
 public:
  using Sink = std::function<void(RigTime edge)>;
  /// `cameras` learns of each edge that passes, in order of time.
  MockTrigger(const Clock& clock, const TriggerParameters& parameters, std::uint64_t seed, Faults faults, Sink cameras);

  void advance(RigTime now);

  /// An edge from outside, as a trigger-master projector makes it; passes when armed for it.
  void pulse(RigTime at);

 private:
  Status do_arm(TriggerSource source) override;
  Status do_disarm() override;
  Status do_fire(RigTime at) override;
  Result<std::uint64_t> do_count() override;
  Result<std::vector<TriggerEdge>> do_edges() override;

  Status check_plugged(RigTime now) const;
  void schedule(RigTime at);

  const Clock& clock_;
  TriggerParameters parameters_;
  std::uint64_t seed_;
  Faults faults_;
  Sink cameras_;
  std::uint64_t asked_ = 0;  ///< edges asked for since the device's start: the counter of their noise
  bool armed_ = false;
  bool external_ = false;
  std::vector<RigTime> scheduled_;  ///< in order of time
  std::deque<TriggerEdge> unread_;
  std::uint64_t seen_ = 0;
};

}  // namespace raysteer::hal::mock
