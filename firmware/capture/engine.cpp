// The way through a capture: devices ready, look by look, and what to do when it ends badly.
#include "firmware/capture/engine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace raysteer::firmware::capture {
namespace {

using std::chrono::nanoseconds;

/// Notice given to the mirror: a command at the very instant may come too late.
constexpr nanoseconds kNotice{2'000'000};

double milliseconds(nanoseconds time) { return static_cast<double>(time.count()) * 1e-6; }

int find_pattern(PatternSequence& sequence, PatternKind kind) {
  const std::vector<Pattern> patterns = sequence.patterns();
  const auto found = std::ranges::find_if(patterns, [&](const Pattern& p) { return p.block.kind == kind; });
  if (found == patterns.end()) {
    sequence.blocks.push_back({.kind = kind});
  }
  return static_cast<int>(found - patterns.begin());
}

}  // namespace

Capture::Engine::Engine(const hal::Rig& rig, proto::plan::Plan plan, PatternSequence sequence, Options options,
                        Sink& sink, const EventLog& log)
    : rig_(rig),
      plan_(std::move(plan)),
      sequence_(std::move(sequence)),
      shown_(sequence_),
      patterns_(sequence_.patterns()),
      options_(std::move(options)),
      sink_(sink),
      log_(log),
      shooter_(rig),
      look_done_(plan_.looks.size()) {
  black_ = find_pattern(shown_, PatternKind::kBlack);
  dark_ = std::ranges::all_of(patterns_, [](const Pattern& p) { return p.block.kind == PatternKind::kBlack; });
  white_ = dark_ ? black_ : find_pattern(shown_, PatternKind::kWhite);
}

State Capture::Engine::tick(RigTime now) {
  now_ = now;
  if (state_ == State::kRunning) {
    if (Status status = step(now); !status) {
      stop(std::move(status).error());
    }
  } else if (state_ == State::kWaiting) {
    if (Status status = watch_interlock(); !status) {
      stop(std::move(status).error());
    }
  }
  return state_;
}

void Capture::Engine::go_on(RigTime now) {
  if (state_ == State::kWaiting) {
    state_ = State::kRunning;
    if (Status status = aim(now); !status) {
      stop(std::move(status).error());
    }
  } else if (state_ == State::kFailed) {
    // Everything is measured anew: whoever mended something may have changed it.
    error_.reset();
    findings_.flicker.reset();
    findings_.latency.reset();
    look_retakes_ = 0;
    std::ranges::fill(record_.retakes, 0);
    record_.late_flips = 0;
    stage_ = Stage::kOpen;
    state_ = State::kRunning;
    log_.event(LogLevel::kInfo, "capture.resumed", {{"look", look().name}});
  }
}

Status Capture::Engine::step(RigTime now) {
  RAYSTEER_TRY(watch_interlock());
  if (stage_ == Stage::kOpen) {
    return open(now);
  }
  if (stage_ == Stage::kSettle) {
    return settle(now);
  }
  RAYSTEER_TRY(shooter_.tick(now));
  while (auto outcome = shooter_.next()) {
    RAYSTEER_TRY(take(std::move(*outcome), now));
  }
  findings_.extra_frames = shooter_.extra_frames();
  return shooter_.idle() ? run_over(now) : ok();
}

Status Capture::Engine::watch_interlock() {
  auto interlock = rig_.interlock.state();
  if (!interlock) {
    return std::move(interlock).error();
  }
  if (!interlock->closed) {
    return fail(RCode::kInterlockOpen, "the interlock opened during the capture");
  }
  return rig_.interlock.feed();
}

Status Capture::Engine::open(RigTime now) {
  for (const hal::Eye eye : hal::kEyes) {
    auto info = rig_.cameras.info(eye);
    if (!info) {
      return std::move(info).error();
    }
    const auto e = static_cast<std::size_t>(eye);
    infos_[e] = std::move(*info);
    grids_[e] = Grid(infos_[e].width, infos_[e].height, infos_[e].bits);
  }
  if (!manifest_) {
    manifest_ = blank_manifest();
    auto earlier = sink_.open(*manifest_);
    if (!earlier) {
      return std::move(earlier).error();
    }
    if (earlier->has_value()) {
      RAYSTEER_TRY(adopt_earlier(**earlier));
    }
    fresh_look();
    log_.event(LogLevel::kInfo, "capture.started",
               {{"plan", plan_.name},
                {"looks", plan_.looks.size()},
                {"patterns", patterns_.size()},
                {"kept_shots", shots_done_},
                {"projector", display() ? "display" : "trigger-master"}});
  }
  if (rig_.projector.loaded() != shown_) {
    RAYSTEER_TRY(rig_.projector.load(shown_));
  }
  if (exposure_fixed()) {
    findings_.exposure = std::chrono::microseconds(std::llround(*plan_.exposure_us));
  }
  RAYSTEER_TRY(rig_.projector.light(true));
  return enter_look(now);
}

Status Capture::Engine::enter_look(RigTime now) {
  const auto next = std::ranges::find(look_done_, false);
  if (next == look_done_.end()) {
    return finish();
  }
  look_ = static_cast<std::size_t>(next - look_done_.begin());
  most_exposure_ = std::min(infos_[0].most_exposure, infos_[1].most_exposure);
  if (!look().prepare.empty() && !prepared_) {
    prepared_ = true;
    state_ = State::kWaiting;
    log_.event(LogLevel::kInfo, "capture.waiting", {{"look", look().name}, {"prepare", look().prepare}});
    return ok();
  }
  return aim(now);
}

Status Capture::Engine::aim(RigTime now) {
  aimed_ = now + kNotice;
  stage_ = Stage::kSettle;
  return rig_.mirror.aim({Radians(look().mirror_rad[0]), Radians(look().mirror_rad[1])}, aimed_);
}

Status Capture::Engine::settle(RigTime now) {
  auto settled = rig_.mirror.settled();
  if (!settled) {
    return std::move(settled).error();
  }
  if (*settled) {
    log_.event(LogLevel::kInfo, "capture.settled",
               {{"look", look().name}, {"took_ms", milliseconds(std::max(now - aimed_, nanoseconds(0)))}});
    return findings_.flicker ? begin_references(now) : begin_ambient(now);
  }
  if (now < aimed_ + options_.settle_timeout) {
    return ok();
  }
  auto reading = rig_.mirror.feedback();
  if (!reading) {
    return std::move(reading).error();
  }
  const std::array seen{reading->angles.axis1.raw(), reading->angles.axis2.raw()};
  const std::array off{seen[0] - look().mirror_rad[0], seen[1] - look().mirror_rad[1]};
  const std::size_t worst = std::abs(off[1]) > std::abs(off[0]) ? 1 : 0;
  char text[160];
  std::snprintf(text, sizeof text,
                "look '%s': %.0f ms after the command axis %zu stands %.3f mrad away from it, expected %.3f mrad",
                look().name.c_str(), milliseconds(options_.settle_timeout), worst + 1, 1e3 * off[worst],
                1e3 * rig_.mirror.settle_rule().tolerance.raw());
  return fail(RCode::kMirrorNotSettled, text, static_cast<std::int64_t>(worst + 1));
}

Status Capture::Engine::run_over(RigTime now) {
  switch (stage_) {
    case Stage::kAmbient:
      return end_ambient(now);
    case Stage::kReferences:
      return end_references(now);
    case Stage::kLatency:
      return end_latency(now);
    case Stage::kPatterns:
      return end_patterns(now);
    case Stage::kClosing:
      return end_closing(now);
    case Stage::kOpen:
    case Stage::kSettle:
      break;
  }
  return ok();
}

Status Capture::Engine::finish() {
  make_safe();
  RAYSTEER_TRY(sink_.finish(manifest()));
  state_ = State::kDone;
  int retakes = 0;
  for (const auto& [rcode, count] : findings_.retakes) {
    retakes += count;
  }
  log_.event(LogLevel::kInfo, "capture.done",
             {{"shots", shots_done_}, {"retakes", retakes}, {"extra_frames", findings_.extra_frames}});
  return ok();
}

// Off always reaches the devices that are there; what the others answer changes nothing now.
void Capture::Engine::make_safe() {
  static_cast<void>(rig_.projector.light(false));
  if (rig_.player != nullptr) {
    static_cast<void>(rig_.player->stop());
  }
  static_cast<void>(rig_.trigger.disarm());
  static_cast<void>(rig_.cameras.stop());
}

void Capture::Engine::stop(Error error) {
  make_safe();
  state_ = State::kFailed;
  log_.event(LogLevel::kError, "capture.failed",
             {{"code", to_string(error.rcode)},
              {"look", look().name},
              {"shots", shots_done_},
              {"why", error.note},
              {"advice", explain(error.rcode).remedy}});
  error_ = std::move(error);
  if (manifest_) {
    if (const Status kept = sink_.keep(manifest()); !kept) {
      log_.event(LogLevel::kError, "capture.not_kept",
                 {{"code", to_string(kept.error().rcode)}, {"why", kept.error().note}});
    }
  }
}

Progress Capture::Engine::progress() const {
  Progress progress{.shots_done = shots_done_,
                    .shots_total = frames() * static_cast<int>(plan_.looks.size()),
                    .looks_done = static_cast<int>(std::ranges::count(look_done_, true)),
                    .looks_total = static_cast<int>(plan_.looks.size())};
  if (began_ && shots_done_ > shots_at_start_) {
    progress.left = (now_ - *began_) / (shots_done_ - shots_at_start_) * (progress.shots_total - shots_done_);
  }
  return progress;
}

}  // namespace raysteer::firmware::capture
