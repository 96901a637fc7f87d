// bound to whoever advances the rig: a trigger-master projector: plays stored patterns and pulses at each.
#pragma once

#include <functional>

#include "hal/mock/mock_projector.hpp"
#include "hal/pattern_player.hpp"

namespace raysteer::hal::mock {

struct PlayerParameters {
  std::chrono::microseconds least_exposure{250};
  std::chrono::microseconds least_gap{230};
  std::chrono::nanoseconds start_delay{1'000'000};  ///< from play() to the first exposure
};

class MasterProjector final : public MockProjector, public PatternPlayer {
 public:
  using Pulse = std::function<void(RigTime)>;
  /// `pulse` is the trigger output.
  MasterProjector(const Clock& clock, MockInterlock& interlock, const ProjectorParameters& parameters,
                  const PlayerParameters& player, const Room& room, Faults faults, Pulse pulse);

  void advance(RigTime now) override;

  std::chrono::microseconds least_exposure() const override { return player_.least_exposure; }
  std::chrono::microseconds least_gap() const override { return player_.least_gap; }

 private:
  struct Run {
    PatternRun asked;
    RigTime begin;
    int pulsed = 0;
    bool stopped = false;
    RigTime exposure_begin(int k) const { return begin + k * asked.period; }
    RigTime end() const { return exposure_begin(asked.count - 1) + asked.exposure; }
  };

  bool playing() const override { return run_ && !run_->stopped && clock().now() < run_->end(); }
  int done(RigTime now) const;
  Status do_trigger_output(bool on) override;
  Status do_play(const PatternRun& run) override;
  Status do_stop() override;
  Result<PlayerState> do_state() override;

  PlayerParameters player_;
  Pulse pulse_;
  bool output_ = false;
  std::optional<Run> run_;  ///< the present or last one
};

}  // namespace raysteer::hal::mock
