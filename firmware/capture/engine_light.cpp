// What is measured before patterns: ambient flicker, exposure, the projector's latency.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "firmware/capture/engine.hpp"

namespace raysteer::firmware::capture {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

/// Short against 8.3 ms, the shortest period of mains flicker.
constexpr microseconds kAmbientExposure{2'000};
/// Multiples of 50 ms are whole periods of 100 and of 120 Hz: only the steps of 11.7 ms move the phase, by 0.17 and by
/// 0.40 of a period. Uneven numbers of them, so that an edge and its neighbour's frame cannot be confused.
constexpr milliseconds kAmbientRest{50};
constexpr microseconds kAmbientStep{11'700};
constexpr std::array kAmbientRests{0, 1, 3, 4, 5, 7};
constexpr int kMostExposureTries = 8;

double to_ms(nanoseconds time) { return static_cast<double>(time.count()) * 1e-6; }

}  // namespace

Status Capture::Engine::begin_ambient(RigTime now) {
  stage_ = Stage::kAmbient;
  const nanoseconds exposure = std::max(
      {nanoseconds(kAmbientExposure), nanoseconds(infos_[0].least_exposure), nanoseconds(infos_[1].least_exposure)});
  RAYSTEER_TRY(configure(exposure));
  const nanoseconds least = std::max<nanoseconds>(infos_[0].least_period, infos_[1].least_period);
  const auto rests = 1 + least / kAmbientRest;
  std::vector<Order> orders{held_order(black_, false)};
  nanoseconds shown{};
  for (std::size_t k = 0; k < kAmbientRests.size(); ++k) {
    const nanoseconds at = kAmbientRests[k] * rests * kAmbientRest + static_cast<int>(k) * nanoseconds(kAmbientStep);
    if (display()) {
      const nanoseconds vblank = at / frame() * frame();
      orders.back().length = k == 0 ? orders.back().length : vblank - shown;
      orders.push_back({.pattern = black_, .delay = at - vblank, .length = frame()});
      shown = vblank;
    } else {
      const nanoseconds rest = k == 0 ? nanoseconds(kAmbientRest) : at - shown - exposure;
      orders.push_back({.pattern = black_, .delay = rest, .length = slot_length()});
      shown = at;
    }
  }
  return shoot(std::move(orders), true, now);
}

Status Capture::Engine::end_ambient(RigTime now) {
  for (const Outcome& outcome : outcomes_) {
    if (outcome.fault) {
      const bool no_clock = outcome.fault->rcode == RCode::kShotIncomplete && !shooter_.clock_known();
      RAYSTEER_TRY(retake_run(no_clock ? fail(RCode::kNoCameraClock, outcome.fault->note) : *outcome.fault, now));
      return begin_ambient(now);
    }
  }
  std::vector<AmbientSample> samples;
  for (std::size_t k = 0; k < outcomes_.size(); ++k) {
    const double level = mean(seen_[k][0]) + mean(seen_[k][1]);
    samples.push_back({.middle = outcomes_[k].edge.time_since_epoch(), .level = level / 2});
  }
  const nanoseconds exposure = settings_.exposure;
  findings_.flicker = find_flicker(samples, exposure);
  log_.event(findings_.flicker->noticed ? LogLevel::kWarn : LogLevel::kInfo, "capture.flicker",
             {{"noticed", findings_.flicker->noticed},
              {"hz", findings_.flicker->hz},
              {"modulation", findings_.flicker->modulation},
              {"sigma", findings_.flicker->sigma}});
  run_retakes_ = 0;
  return begin_references(now);
}

std::optional<nanoseconds> Capture::Engine::choose(nanoseconds most, nanoseconds wanted) const {
  const ExposureLimits limits{.least = std::max<nanoseconds>(infos_[0].least_exposure, infos_[1].least_exposure),
                              .most = most,
                              .frame = display() ? std::optional(frame()) : std::nullopt};
  // A frame's period is not a whole number of nanoseconds: 3 frames of 60 Hz are 50 ms.
  auto chosen = choose_exposure(*findings_.flicker, limits, wanted + microseconds(display() ? 50 : 0));
  if (chosen) {
    chosen = std::chrono::floor<microseconds>(*chosen + nanoseconds(500));  // what cameras can be told
  }
  return chosen;
}

Status Capture::Engine::begin_references(RigTime now) {
  stage_ = Stage::kReferences;
  if (findings_.exposure.count() == 0) {
    const auto chosen = choose(most_exposure_, options_.wanted_exposure);
    if (!chosen) {
      return fail(RCode::kBadValue, "the cameras expose for at most " + std::to_string(to_ms(most_exposure_)) +
                                        " ms, a frame of the projector lasts " + std::to_string(to_ms(frame())) +
                                        " ms");
    }
    findings_.exposure = *chosen;
  }
  if (!rig_.cameras.streaming() || settings_.exposure != findings_.exposure) {
    RAYSTEER_TRY(configure(findings_.exposure));
  }
  return shoot({held_order(white_, true), held_order(black_, true)}, false, now);
}

Status Capture::Engine::end_references(RigTime now) {
  for (const Outcome& outcome : outcomes_) {
    if (outcome.fault) {
      RAYSTEER_TRY(retake_run(*outcome.fault, now));
      return begin_references(now);
    }
  }
  const EyeSamples none = {Samples(seen_[1][0].size()), Samples(seen_[1][1].size())};
  References references = make_references(seen_[0], dark_ ? none : seen_[1]);
  const ExposureVerdict verdict = judge_exposure(references);
  if (!exposure_fixed() && verdict != ExposureVerdict::kGood && ++exposure_tries_ < kMostExposureTries) {
    const double factor = exposure_factor(references);
    const nanoseconds present = findings_.exposure;
    const nanoseconds better(std::llround(factor * static_cast<double>(present.count())));
    std::optional<nanoseconds> chosen;
    if (verdict == ExposureVerdict::kTooLong) {
      most_exposure_ = display() ? std::max(better, frame()) : better;
      chosen = choose(most_exposure_, options_.wanted_exposure);
      chosen = chosen && *chosen < present ? chosen : std::nullopt;
    } else {
      chosen = choose(most_exposure_, std::min(better, 4 * options_.wanted_exposure));
      chosen = chosen && *chosen > present ? chosen : std::nullopt;
    }
    if (chosen) {
      findings_.exposure = *chosen;
      return begin_references(now);
    }
  }
  if (Status light = judge_light(references); !light) {
    // Once more, since a single lost picture looks like no light at all.
    RAYSTEER_TRY(retake_run(light.error(), now));
    if (run_retakes_ > 1) {
      return light;
    }
    return begin_references(now);
  }
  return adopt_references(std::move(references), now);
}

Status Capture::Engine::adopt_references(References references, RigTime now) {
  // Shots of this look from before a failure stay only if nothing changed since.
  const auto other_exposure = [&](const std::optional<proto::session::Shot>& shot) {
    return shot && shot->exposure_us != settings_.exposure.count();
  };
  const bool changed = record_.references &&
                       (std::ranges::any_of(record_.shots, other_exposure) ||
                        !judge_stillness(*record_.references, {references.eyes[0].white, references.eyes[1].white}));
  if (!record_.references || changed) {
    begin_record(std::move(references));
  }
  for (std::size_t k = 0; k < 2; ++k) {
    const int index = outcomes_[k].order.pattern;
    if (index < frames() && !record_.shots[static_cast<std::size_t>(index)]) {
      RAYSTEER_TRY(put(index, outcomes_[k], std::move(seen_[k])));
    }
  }
  run_retakes_ = 0;
  exposure_tries_ = 0;
  const References& kept = *record_.references;
  const double left = flicker_left(*findings_.flicker, findings_.exposure);
  const bool doubtful = left > 0.05 || judge_exposure(kept) == ExposureVerdict::kTooLong;
  log_.event(
      doubtful ? LogLevel::kWarn : LogLevel::kInfo, "capture.exposure",
      {{"look", look().name},
       {"exposure_ms", to_ms(findings_.exposure)},
       {"frames",
        display() ? static_cast<double>(findings_.exposure.count()) / static_cast<double>(frame().count()) : 0.0},
       {"flicker_left", left},
       {"left_bright", kept.eyes[0].bright},
       {"right_bright", kept.eyes[1].bright},
       {"left_saturated", kept.eyes[0].saturated_share},
       {"right_saturated", kept.eyes[1].saturated_share},
       {"left_lit", kept.eyes[0].lit_share},
       {"right_lit", kept.eyes[1].lit_share}});
  if (display() && !dark_ && !findings_.latency) {  // black stays black, however late
    search_.emplace(frame(), findings_.exposure, hold());
    return begin_latency(now);
  }
  return begin_patterns(now);
}

Status Capture::Engine::begin_latency(RigTime now) {
  stage_ = Stage::kLatency;
  const LatencySearch::Probe probe = *search_->next();
  Order white{.pattern = white_, .delay = probe.delay, .length = slot_length()};
  if (!probe.as_captured) {
    white.length = whole_frames(hold() + findings_.exposure);
  }
  return shoot({held_order(black_, false), white, held_order(black_, false)}, false, now);
}

Status Capture::Engine::end_latency(RigTime now) {
  if (outcomes_.front().fault) {
    RAYSTEER_TRY(retake_run(*outcomes_.front().fault, now));
    return begin_latency(now);
  }
  search_->take(uniform_level(*record_.references, seen_.front()));
  if (search_->next()) {
    return begin_latency(now);
  }
  findings_.latency = search_->latency();
  run_retakes_ = 0;
  if (!findings_.latency) {
    return fail(
        RCode::kLatencyUnknown,
        search_->plateau() > 0
            ? "white for a whole shot reached only " + std::to_string(search_->plateau()) + " of steady white"
            : "white did not become light within " + std::to_string(options_.longest_latency_frames) + " frames");
  }
  log_.event(LogLevel::kInfo, "capture.latency",
             {{"latency_ms", to_ms(*findings_.latency)},
              {"frames", static_cast<double>(findings_.latency->count()) / static_cast<double>(frame().count())},
              {"plateau", search_->plateau()}});
  return begin_patterns(now);
}

}  // namespace raysteer::firmware::capture
