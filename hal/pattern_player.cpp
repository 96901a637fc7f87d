#include "hal/pattern_player.hpp"

#include <string>

namespace raysteer::hal {
namespace {

std::string us(std::chrono::microseconds duration) { return std::to_string(duration.count()) + " us"; }

}  // namespace

Status PatternPlayer::refuse_while_playing() {
  const Result<PlayerState> now = do_state();
  if (!now) {
    return now.error();
  }
  if (now->playing) {
    return fail(RCode::kProjectorBusy, std::to_string(now->done) + " patterns of the present run are done", now->done);
  }
  return ok();
}

Status PatternPlayer::trigger_output(bool on) {
  RAYSTEER_TRY(refuse_while_playing());
  return do_trigger_output(on);
}

Status PatternPlayer::play(const PatternRun& run) {
  const int loaded = projector_.loaded().frames();
  if (run.first < 0 || run.count < 1 || run.first > loaded - run.count) {
    return fail(RCode::kNothingStored, std::to_string(run.count) + " patterns from " + std::to_string(run.first) +
                                           " on asked for, " + std::to_string(loaded) + " are loaded");
  }
  if (run.exposure < least_exposure()) {
    return fail(RCode::kBadValue,
                "a pattern must be lit for at least " + us(least_exposure()) + ", asked " + us(run.exposure));
  }
  if (run.period - run.exposure < least_gap()) {
    return fail(RCode::kBadValue, "the gap between patterns must be at least " + us(least_gap()) + ", asked " +
                                      us(run.period - run.exposure));
  }
  RAYSTEER_TRY(refuse_while_playing());
  return do_play(run);
}

}  // namespace raysteer::hal
