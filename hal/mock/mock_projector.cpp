#include "hal/mock/mock_projector.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/mock/panel_picture.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {

MockProjector::MockProjector(const Clock& clock, MockInterlock& interlock, const ProjectorParameters& parameters,
                             const Room& room, Faults faults)
    : Projector(clock, interlock, parameters.panel),
      interlock_(interlock),
      parameters_(parameters),
      room_(room),
      faults_(std::move(faults)),
      response_(panel_response(parameters.gamma, parameters.black)),
      dark_(flat_picture(0, parameters.panel.width, parameters.panel.height, response_)),
      desktop_(flat_picture(90, parameters.panel.width, parameters.panel.height, response_)),
      lit_({.upper = dark_, .lower = dark_, .split = 0}),
      lamp_({.on = false,
             .missing = parameters.lamp_missing_cold *
                        std::exp(-parameters.lamp.on_before_s / parameters.lamp.time_constant_s)}) {}

Status MockProjector::check_answers() {
  if (faults_.lasting("unplug", clock().now())) {
    return fail(RCode::kDeviceUnavailable, "the projector");
  }
  if (faults_.take("nak", clock().now())) {
    return fail(RCode::kDeviceUnavailable, "the projector did not answer a command");
  }
  return ok();
}

double MockProjector::lamp_missing(RigTime at) const {
  const Lamp& lamp = lamp_.at(at);
  const RigTime since = std::max(lamp_.change_before(at), RigTime{});
  const double gone = std::exp(-seconds(at - since) / parameters_.lamp.time_constant_s);
  const double cold = parameters_.lamp_missing_cold;
  return lamp.on ? lamp.missing * gone : cold + (lamp.missing - cold) * gone;
}

void MockProjector::switch_lamp(RigTime at, bool on) {
  if (lamp_.last().on != on) {
    lamp_.set(at, {.on = on, .missing = lamp_missing(at)});
  }
}

Status MockProjector::do_light(bool on) {
  if (!on) {
    switch_lamp(clock().now(), false);  // by wire, past a controller that does not answer
    return check_answers();
  }
  RAYSTEER_TRY(check_answers());
  switch_lamp(clock().now(), true);
  return ok();
}

Status MockProjector::do_load(const PatternSequence& sequence) {
  RAYSTEER_TRY(check_answers());
  const int needed = sequence.frames() + static_cast<int>(contents_.size());
  if (needed > parameters_.pictures) {
    return fail(RCode::kDeviceFull, "memory for " + std::to_string(parameters_.pictures) + " pictures, " +
                                        std::to_string(needed) + " asked for");
  }
  std::vector<Picture> pictures;
  for (const Pattern& pattern : sequence.patterns()) {
    pictures.push_back(pattern_picture(pattern, panel().width, panel().height, response_));
  }
  patterns_ = std::move(pictures);
  waiting_.reset();
  lit_from(clock().now(), dark_);
  return ok();
}

Status MockProjector::do_store(int number, ImageView<const std::uint8_t> picture) {
  RAYSTEER_TRY(check_answers());
  const std::size_t needed = patterns_.size() + contents_.size() + (contents_.contains(number) ? 0 : 1);
  if (needed > static_cast<std::size_t>(parameters_.pictures)) {
    return fail(RCode::kDeviceFull, "memory for " + std::to_string(parameters_.pictures) + " pictures, " +
                                        std::to_string(needed) + " asked for");
  }
  contents_[number] = content_picture(picture, response_);
  return ok();
}

Status MockProjector::do_show(Shown what, RigTime at) {
  RAYSTEER_TRY(check_answers());
  waiting_ = {.what = what, .at = at};
  return ok();
}

Result<std::optional<Presented>> MockProjector::do_presented() {
  RAYSTEER_TRY(check_answers());
  return presented_;
}

const MockProjector::Picture& MockProjector::stored(const Shown& what) const {
  if (const auto* pattern = std::get_if<StoredPattern>(&what)) {
    return patterns_[static_cast<std::size_t>(pattern->index)];
  }
  if (const auto* content = std::get_if<ContentFrame>(&what)) {
    return contents_.at(content->number);
  }
  return dark_;
}

void MockProjector::scan_out(std::uint64_t vblank, RigTime at) {
  if (!waiting_ || waiting_->at > at || faults_.take("late", at)) {
    return;
  }
  const Shown what = waiting_->what;
  waiting_.reset();
  presented_ = {.what = what, .vblank = vblank, .stamp = at};
  const double frames = parameters_.latency_frames + faults_.lasting("latency", at).value_or(0);
  const RigTime light = at + duration(frames * seconds(panel().frame_period));
  const Picture& next = stored(what);
  if (faults_.take("drop", at)) {
    lit_from(light + panel().frame_period, next);
  } else if (const std::optional<double> tear = faults_.take("tear", at)) {
    const Picture before = lit_.at(light).lower;
    const int split = static_cast<int>(std::clamp(*tear, 0.0, 1.0) * panel().height);
    lit_.set(light, {.upper = before, .lower = next, .split = split});
    lit_.set(light + panel().frame_period, {.upper = next, .lower = next, .split = 0});
  } else {
    lit_from(light, next);
  }
}

void MockProjector::advance(RigTime now) {
  const auto vblank_at = [&](std::uint64_t n) {
    return RigTime(parameters_.first_vblank) + static_cast<std::int64_t>(n) * panel().frame_period;
  };
  for (RigTime at = vblank_at(next_vblank_); at <= now; at = vblank_at(++next_vblank_)) {
    scan_out(next_vblank_, at);
  }
  if (lamp_.last().on) {
    if (const std::optional<RigTime> cut = interlock_.first_open(lamp_.last_change(), now)) {
      switch_lamp(*cut, false);
    }
  }
  const RigTime old = now - std::chrono::seconds(5);
  lit_.forget(old);
  lamp_.forget(old);
}

ProjectorPx MockProjector::drift(RigTime at) const {
  const double warm = parameters_.warm_up.since_start(seconds(at));
  const double kelvin = room_.kelvin(seconds(at));
  const auto stepped = [&](double px) {
    return parameters_.drift_step_px > 0 ? parameters_.drift_step_px * std::round(px / parameters_.drift_step_px) : px;
  };
  return {stepped(parameters_.drift_warm.x * warm + parameters_.drift_per_k.x * kelvin),
          stepped(parameters_.drift_warm.y * warm + parameters_.drift_per_k.y * kelvin)};
}

std::vector<LightSpan> MockProjector::light_between(RigTime begin, RigTime end) const {
  std::vector<LightSpan> spans;
  for (RigTime at = begin; at < end;) {
    const RigTime next = std::min({end, lit_.next_change(at), lamp_.next_change(at)});
    const RigTime middle = at + (next - at) / 2;
    Lit lit = lit_.at(at);
    if (faults_.lasting("wrong-screen", at)) {
      lit = {.upper = desktop_, .lower = desktop_, .split = 0};
    }
    const bool shines = lamp_.at(at).on && !faults_.lasting("lamp-off", at) && !faults_.lasting("unplug", at);
    const LightSpan whole{.begin = at,
                          .end = next,
                          .picture = shines ? lit.lower : nullptr,
                          .first_row = 0,
                          .end_row = panel().height,
                          .power = 1 - lamp_missing(middle),
                          .drift = drift(middle),
                          .mirror = {}};
    if (whole.picture != nullptr && lit.split > 0) {
      spans.push_back(whole);
      spans.back().picture = lit.upper;
      spans.back().end_row = lit.split;
      spans.push_back(whole);
      spans.back().first_row = lit.split;
    } else if (whole.picture != nullptr) {
      spans.push_back(whole);
    }
    at = next;
  }
  return spans;
}

}  // namespace raysteer::hal::mock
