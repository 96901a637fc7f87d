// Shots: asked for, verified, taken again, handed to the sink.
#include <algorithm>
#include <string>
#include <utility>
#include <variant>

#include "firmware/capture/engine.hpp"
#include "firmware/capture/pattern_test.hpp"
#include "firmware/capture/verify.hpp"

namespace raysteer::firmware::capture {
namespace {

using std::chrono::microseconds;
using std::chrono::nanoseconds;

/// The sensor's noise and its tolerance of "settled", several times over.
constexpr double kMirrorTolerances = 5;
/// Below, stripes have no edges: 0.3 is what a blur of four projector pixels leaves of 16.
constexpr double kLeastContrast = 0.08;
/// Of a look's patterns; more late pictures are a fault of the display (faults B 17).
constexpr double kMostLateFlips = 0.05;
constexpr int kLateFlipsForgiven = 3;
/// Share of a look's frames; more wrong ones have one cause.
constexpr double kMostWrong = 0.4;
/// Between a picture's end and the next exposure, beyond what the devices need.
constexpr microseconds kSlack{500};

}  // namespace

nanoseconds Capture::Engine::whole_frames(nanoseconds time) const {
  return (time + frame() - nanoseconds(1)) / frame() * frame();
}

nanoseconds Capture::Engine::slot_length() const {
  const nanoseconds exposure = settings_.exposure;
  const nanoseconds least = kSlack + std::max(infos_[0].least_period, infos_[1].least_period);
  if (display()) {
    return whole_frames(std::max(exposure + 2 * latency_guard(frame()), least));
  }
  return std::chrono::ceil<microseconds>(std::max(exposure + rig_.player->least_gap() + kSlack, least));
}

Order Capture::Engine::pattern_order(int pattern) const {
  const nanoseconds delay = display() ? findings_.latency.value_or(hold()) + latency_guard(frame()) : nanoseconds(0);
  return {.pattern = pattern, .delay = delay, .length = slot_length()};
}

// Shown for so long that the latency does not matter.
Order Capture::Engine::held_order(int pattern, bool shot) const {
  if (!display()) {
    return {.pattern = pattern, .length = slot_length(), .shot = shot};
  }
  return {.pattern = pattern,
          .delay = hold(),
          .length = whole_frames(hold() + (shot ? slot_length() : nanoseconds(0))),
          .shot = shot};
}

Status Capture::Engine::configure(nanoseconds exposure) {
  RAYSTEER_TRY(rig_.cameras.stop());
  settings_ = {.exposure = std::chrono::duration_cast<microseconds>(exposure), .gain_db = options_.gain_db};
  RAYSTEER_TRY(rig_.cameras.configure(settings_));
  RAYSTEER_TRY(rig_.trigger.arm(display() ? hal::TriggerSource::kFired : hal::TriggerSource::kExternal));
  shooter_.streams_started();
  just_started_ = true;
  return rig_.cameras.start();
}

Status Capture::Engine::shoot(std::vector<Order> orders, bool learn, RigTime now) {
  outcomes_.clear();
  seen_.clear();
  if (std::exchange(just_started_, false) && orders.front().shot) {
    // Some cameras send a frame that nobody triggered when streaming starts, and see no edge meanwhile.
    const nanoseconds rest =
        settings_.exposure + std::max(infos_[0].least_period, infos_[1].least_period) + microseconds(kSlack);
    if (display()) {
      orders.insert(orders.begin(), {.pattern = orders.front().pattern, .length = whole_frames(rest), .shot = false});
    } else {
      orders.front().delay = std::max(orders.front().delay, rest);
    }
  }
  return shooter_.begin(orders, settings_.exposure, learn, now);
}

EyeSamples Capture::Engine::sample(const hal::FramePair& pair) const {
  return {grids_[0].sample(pair.left->pixels), grids_[1].sample(pair.right->pixels)};
}

std::optional<Error> Capture::Engine::verify(const Outcome& outcome) const {
  if (outcome.fault) {
    return outcome.fault;
  }
  if (Status status = verify_pair(outcome.pair, infos_, settings_); !status) {
    return std::move(status).error();
  }
  if (outcome.mirror) {
    const Radians tolerance = rig_.mirror.settle_rule().tolerance * kMirrorTolerances;
    if (Status status = verify_mirror(*outcome.mirror, *rig_.mirror.last_commanded(), tolerance); !status) {
      return std::move(status).error();
    }
  }
  return std::nullopt;
}

Status Capture::Engine::take(Outcome outcome, RigTime now) {
  outcome.fault = verify(outcome);
  const bool automatic = outcome.fault && outcome.fault->rcode == RCode::kAutomaticExposure;
  if (stage_ != Stage::kPatterns) {
    seen_.push_back(outcome.fault ? EyeSamples{} : sample(outcome.pair));
    outcomes_.push_back(std::move(outcome));
    if (automatic) {
      settings_.exposure = {};  // set anew before the next run
    }
    return ok();
  }
  const int index = outcome.order.pattern;
  if (!outcome.fault) {
    EyeSamples samples = sample(outcome.pair);
    return put(index, outcome, std::move(samples));
  }
  RAYSTEER_TRY(count_retake(index, *outcome.fault));
  if (automatic) {
    // It stays on: what else is under way is of no use either.
    if (rig_.player != nullptr) {
      RAYSTEER_TRY(rig_.player->stop());
    }
    RAYSTEER_TRY(configure(findings_.exposure));
    log_.event(LogLevel::kWarn, "capture.automatic_off", {{"look", look().name}, {"pattern", index}});
    return begin_patterns(now);
  }
  if (outcome.fault->rcode == RCode::kMirrorMoved) {
    return retake_look(*outcome.fault, now);
  }
  return ok();
}

Status Capture::Engine::put(int index, Outcome& outcome, EyeSamples samples) {
  const auto i = static_cast<std::size_t>(index);
  const auto ns = [](auto instant) { return static_cast<std::int64_t>(instant.time_since_epoch().count()); };
  proto::session::Shot shot;
  shot.look = look().name;
  shot.index = index;
  shot.rig_time_ns = ns(outcome.shown);
  shot.trigger_time_ns = ns(outcome.edge);
  shot.exposure_us = outcome.pair.left->exposure.count();
  shot.mirror_command = std::vector(look().mirror_rad.begin(), look().mirror_rad.end());
  if (outcome.mirror) {
    shot.mirror_feedback = {outcome.mirror->angles.axis1.raw(), outcome.mirror->angles.axis2.raw()};
  }
  shot.camera_times_ns = {ns(outcome.pair.left->stamp), ns(outcome.pair.right->stamp)};
  for (const hal::Eye eye : hal::kEyes) {
    std::visit([&](const auto& pixels) { record_.checks[static_cast<std::size_t>(eye)]->add(index, pixels.view()); },
               outcome.pair.eye(eye)->pixels);
  }
  RAYSTEER_TRY(sink_.put(*manifest_, shot, std::move(outcome.pair)));
  if (!began_) {
    began_ = outcome.edge;
  }
  shots_done_ += record_.shots[i] ? 0 : 1;
  record_.shots[i] = std::move(shot);
  record_.samples[i] = std::move(samples);
  return ok();
}

Status Capture::Engine::count_retake(int index, const Error& why) {
  const auto i = static_cast<std::size_t>(index);
  ++findings_.retakes[why.rcode];
  const int attempt = ++record_.retakes[i];
  record_.late_flips += why.rcode == RCode::kFlipLate ? 1 : 0;
  const std::string place = "look '" + look().name + "', pattern " + std::to_string(index);
  log_.event(LogLevel::kWarn, "capture.retake",
             {{"look", look().name},
              {"pattern", index},
              {"attempt", attempt},
              {"code", to_string(why.rcode)},
              {"why", why.note},
              {"advice", explain(why.rcode).remedy}});
  if (attempt > options_.most_retakes) {
    return with_context(why, place + ", taken " + std::to_string(attempt) + " times");
  }
  if (record_.late_flips > kLateFlipsForgiven && record_.late_flips > kMostLateFlips * frames()) {
    return with_context(why, place + ", " + std::to_string(record_.late_flips) + " late pictures in one look");
  }
  return ok();
}

Status Capture::Engine::retake_run(const Error& why, RigTime) {
  ++findings_.retakes[why.rcode];
  ++run_retakes_;
  log_.event(LogLevel::kWarn, "capture.retake",
             {{"look", look().name},
              {"pattern", stage_ == Stage::kAmbient   ? "ambient"
                          : stage_ == Stage::kLatency ? "latency"
                                                      : "white"},
              {"attempt", run_retakes_},
              {"code", to_string(why.rcode)},
              {"why", why.note},
              {"advice", explain(why.rcode).remedy}});
  if (run_retakes_ > options_.most_retakes) {
    return with_context(why, "look '" + look().name + "', taken " + std::to_string(run_retakes_) + " times");
  }
  if (why.rcode == RCode::kAutomaticExposure) {
    settings_.exposure = {};
  }
  return ok();
}

Status Capture::Engine::retake_look(const Error& why, RigTime now) {
  ++findings_.look_retakes[why.rcode];
  log_.event(LogLevel::kWarn, "capture.look_retake",
             {{"look", look().name},
              {"attempt", look_retakes_ + 1},
              {"code", to_string(why.rcode)},
              {"why", why.note},
              {"advice", explain(why.rcode).remedy}});
  if (++look_retakes_ > options_.most_retakes) {
    return with_context(why, "look '" + look().name + "', taken " + std::to_string(look_retakes_) + " times");
  }
  if (rig_.player != nullptr) {
    RAYSTEER_TRY(rig_.player->stop());
  }
  fresh_look();
  return aim(now);
}

Status Capture::Engine::begin_patterns(RigTime now) {
  stage_ = Stage::kPatterns;
  std::vector<Order> orders;
  for (int index = 0; index < frames(); ++index) {
    if (!record_.shots[static_cast<std::size_t>(index)]) {
      orders.push_back(pattern_order(index));
    }
  }
  return shoot(std::move(orders), false, now);
}

Status Capture::Engine::end_patterns(RigTime now) {
  const std::vector<WrongFrame> all_wrong = find_wrong_frames(sequence_, *record_.references, record_.samples);
  const bool again = std::ranges::any_of(
      all_wrong, [&](const WrongFrame& wrong) { return record_.retakes[static_cast<std::size_t>(wrong.index)] > 0; });
  if (again || static_cast<double>(all_wrong.size()) > kMostWrong * frames()) {
    // Not single pictures: the latency changed, or a reference is wrong. Both are measured anew.
    findings_.latency.reset();
    return retake_look(
        fail(RCode::kWrongPattern, std::to_string(all_wrong.size()) + " of " + std::to_string(frames()) +
                                       " frames contradict their partners" + (again ? ", not for the first time" : "")),
        now);
  }
  for (const WrongFrame& wrong : all_wrong) {
    const auto i = static_cast<std::size_t>(wrong.index);
    record_.samples[i].reset();
    record_.shots[i].reset();
    --shots_done_;
    RAYSTEER_TRY(count_retake(
        wrong.index,
        fail(RCode::kWrongPattern,
             std::to_string(wrong.share * 100) + " % of the lit places contradict " + wrong.contradicts, wrong.index)));
  }
  const bool all = std::ranges::all_of(record_.shots, [](const auto& shot) { return shot.has_value(); });
  return all ? begin_closing(now) : begin_patterns(now);
}

Status Capture::Engine::begin_closing(RigTime now) {
  stage_ = Stage::kClosing;
  return shoot({pattern_order(white_)}, false, now);
}

Status Capture::Engine::end_closing(RigTime now) {
  const Outcome& white = outcomes_.front();
  if (white.fault) {
    if (white.fault->rcode == RCode::kMirrorMoved) {
      return retake_look(*white.fault, now);
    }
    RAYSTEER_TRY(retake_run(*white.fault, now));
    if (settings_.exposure != findings_.exposure) {
      RAYSTEER_TRY(configure(findings_.exposure));
    }
    return begin_closing(now);
  }
  run_retakes_ = 0;
  if (Status still = judge_stillness(*record_.references, seen_.front()); !still) {
    return retake_look(still.error(), now);
  }
  const auto contrast = finest_contrast(sequence_, *record_.references, record_.samples);
  if (contrast && *contrast < kLeastContrast) {
    return fail(RCode::kOutOfFocus, "look '" + look().name + "': the finest stripes have a contrast of " +
                                        std::to_string(*contrast) + ", expected at least " +
                                        std::to_string(kLeastContrast));
  }
  for (const auto& check : record_.checks) {
    if (dark_) {
      break;  // no sequence to be recognised
    }
    if (Status verdict = check->verdict(); !verdict) {
      return retake_look(verdict.error(), now);
    }
  }
  return end_look(now);
}

Status Capture::Engine::end_look(RigTime now) {
  for (std::optional<proto::session::Shot>& shot : record_.shots) {
    manifest_->shots.push_back(std::move(*shot));
  }
  record_.shots.clear();
  fresh_look();
  look_done_[look_] = true;
  look_retakes_ = 0;
  prepared_ = false;
  log_.event(LogLevel::kInfo, "capture.look_done", {{"look", look().name}, {"shots", shots_done_}});
  RAYSTEER_TRY(sink_.keep(manifest()));
  return enter_look(now);
}

}  // namespace raysteer::firmware::capture
