// bound to whoever advances the rig: a mirror that lags, rings, drifts and errs.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "hal/mirror.hpp"
#include "hal/mock/fault.hpp"
#include "hal/mock/history.hpp"
#include "hal/mock/mirror_parameters.hpp"
#include "hal/mock/servo.hpp"

namespace raysteer::hal::mock {

class MockMirror final : public Mirror {
 public:
  MockMirror(const Clock& clock, const MirrorParameters& parameters, const Room& room, std::uint64_t seed,
             Faults faults);

  /// Moves on. Time is cut into steps that begin with each command, so that results do not depend on how often this
  /// is called.
  void advance(RigTime now);

  /// Where it truly stands at `at`, which is not after the last advance() (else: as if it had stood still since) and at
  /// most some seconds before.
  MirrorAngles true_angles(RigTime at) const;
  /// Does it move by more than a step of its drift anywhere between? Drift itself does not count.
  bool moves(RigTime begin, RigTime end) const;
  /// Where the curve and today's drift put `command` on average: no repeatability, no hysteresis.
  MirrorAngles mean_angles(MirrorAngles command, RigTime at) const;

  const MirrorParameters& parameters() const { return parameters_; }

 private:
  using Pair = std::array<double, 2>;
  struct Command {
    Pair target{};
    RigTime at{};
    RigTime effective{};  ///< after the pure delay
  };
  /// The resting error (repeatability and hysteresis): goes from `before` to `after` with the loop's own time constant.
  struct RestingError {
    RigTime begin{};
    Pair before{};
    Pair after{};
  };
  struct Sample {
    RigTime at;
    Pair position;
  };

  Status do_aim(MirrorAngles target, RigTime at) override;
  Result<MirrorReading> do_feedback() override;

  void begin(const Command& command);
  void step_to(RigTime next);
  void record(RigTime now);
  Status check_plugged(RigTime now) const;
  Pair position_at(RigTime at) const;
  Pair resting_error_at(RigTime at) const;
  Pair drifted(Pair angles, RigTime at) const;
  Pair curve(Pair command) const;

  const Clock& clock_;
  MirrorParameters parameters_;
  Room room_;
  std::uint64_t seed_;
  Faults faults_;
  std::chrono::nanoseconds step_;

  RigTime time_{};
  std::array<Servo, 2> servos_;
  std::deque<Sample> samples_;
  std::deque<Command> commands_;
  History<RestingError> resting_{RestingError{}};
  Pair approach_{};  ///< side each axis came from last, +-1
  std::uint64_t aims_ = 0;
  std::uint64_t readings_ = 0;
};

}  // namespace raysteer::hal::mock
