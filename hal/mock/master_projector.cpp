#include "hal/mock/master_projector.hpp"

#include <algorithm>

namespace raysteer::hal::mock {

MasterProjector::MasterProjector(const Clock& clock, MockInterlock& interlock, const ProjectorParameters& parameters,
                                 const PlayerParameters& player, const Room& room, Faults faults, Pulse pulse)
    : MockProjector(clock, interlock, parameters, room, std::move(faults)),
      PatternPlayer(static_cast<Projector&>(*this)),
      player_(player),
      pulse_(std::move(pulse)) {}

void MasterProjector::advance(RigTime now) {
  MockProjector::advance(now);
  if (run_) {
    for (; run_->pulsed < run_->asked.count && run_->exposure_begin(run_->pulsed) <= now; ++run_->pulsed) {
      if (output_) {
        pulse_(run_->exposure_begin(run_->pulsed));
      }
    }
  }
}

Status MasterProjector::do_trigger_output(bool on) {
  RAYSTEER_TRY(check_answers());
  output_ = on;
  return ok();
}

Status MasterProjector::do_play(const PatternRun& asked) {
  RAYSTEER_TRY(check_answers());
  run_ = {.asked = asked, .begin = clock().now() + player_.start_delay};
  forget_waiting();
  lit_from(clock().now(), dark());
  for (int k = 0; k < asked.count; ++k) {
    const RigTime begin = run_->exposure_begin(k);
    lit_from(begin, stored(StoredPattern{asked.first + k}));
    lit_from(begin + asked.exposure, nullptr);  // the source is off between exposures
  }
  lit_from(run_->end(), dark());
  return ok();
}

Status MasterProjector::do_stop() {
  RAYSTEER_TRY(check_answers());
  if (playing()) {
    const RigTime now = clock().now();
    run_->asked.count = done(now);
    run_->stopped = true;
    lit_from(now, dark());
  }
  return ok();
}

int MasterProjector::done(RigTime now) const {
  if (!run_ || run_->asked.count == 0 || now < run_->begin + run_->asked.exposure) {
    return 0;
  }
  const auto ended = (now - run_->begin - run_->asked.exposure) / run_->asked.period + 1;
  return static_cast<int>(std::min<std::int64_t>(ended, run_->asked.count));
}

Result<PlayerState> MasterProjector::do_state() {
  RAYSTEER_TRY(check_answers());
  return PlayerState{.playing = playing(), .done = done(clock().now())};
}

}  // namespace raysteer::hal::mock
