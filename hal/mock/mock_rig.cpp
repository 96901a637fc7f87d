#include "hal/mock/mock_rig.hpp"

#include <algorithm>

#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {

Result<std::unique_ptr<MockRig>> MockRig::make(const RigParameters& parameters, SceneFunction scene) {
  for (const Fault& fault : parameters.faults) {
    RAYSTEER_TRY(check(fault));
  }
  return std::unique_ptr<MockRig>(new MockRig(parameters, std::move(scene)));
}

MockRig::MockRig(const RigParameters& parameters, SceneFunction scene)
    : parameters_(parameters),
      clock_faults_(parameters.faults, "clock"),
      interlock_(clock_, parameters.interlock, Faults(parameters.faults, "interlock")),
      mirror_(clock_, parameters.mirror, parameters.room, parameters.seed, Faults(parameters.faults, "mirror")),
      projector_(make_projector()),
      cameras_(
          clock_, parameters.cameras, parameters.seed, parameters.faults,
          [this](RigTime begin, RigTime end) { return light_between(begin, end); }, scene),
      trigger_(clock_, parameters.trigger, parameters.seed, Faults(parameters.faults, "trigger"),
               [this](RigTime edge) { cameras_.edge(edge); }),
      store_(clock_, parameters.store, Faults(parameters.faults, "store")) {
  RAYSTEER_CHECK(parameters.tick.count() > 0);
}

std::unique_ptr<MockProjector> MockRig::make_projector() {
  Faults faults(parameters_.faults, "projector");
  if (!parameters_.player) {
    return std::make_unique<MockProjector>(clock_, interlock_, parameters_.projector, parameters_.room,
                                           std::move(faults));
  }
  auto master = std::make_unique<MasterProjector>(clock_, interlock_, parameters_.projector, *parameters_.player,
                                                  parameters_.room, std::move(faults),
                                                  [this](RigTime at) { trigger_.pulse(at); });
  player_ = master.get();
  return master;
}

void MockRig::advance_to(RigTime now) {
  while (clock_.now() < now) {
    // Ticks stand on a grid of their own, so that results do not depend on who advances how far at a time.
    const auto since = clock_.now().time_since_epoch();
    const RigTime next = std::min(now, RigTime((since / parameters_.tick + 1) * parameters_.tick));
    clock_.advance_to(next);
    if (const std::optional<double> step = clock_faults_.take("step", next)) {
      clock_.step_wall_clock(duration(*step));
    }
    interlock_.advance(next);
    projector_->advance(next);
    trigger_.advance(next);
    mirror_.advance(next);
    cameras_.advance(next);
  }
}

hal::Rig MockRig::rig() {
  return {.clock = clock_,
          .interlock = interlock_,
          .mirror = mirror_,
          .projector = *projector_,
          .player = player_,
          .trigger = trigger_,
          .cameras = cameras_,
          .store = store_};
}

std::vector<LightSpan> MockRig::light_between(RigTime begin, RigTime end) const {
  constexpr std::chrono::microseconds kMoving{1'000};  // a span of a moving mirror is no longer
  std::vector<LightSpan> spans;
  for (const LightSpan& whole : projector_->light_between(begin, end)) {
    const bool moves = mirror_.moves(whole.begin, whole.end);
    for (RigTime at = whole.begin; at < whole.end;) {
      LightSpan span = whole;
      span.begin = at;
      span.end = moves ? std::min<RigTime>(whole.end, at + kMoving) : whole.end;
      span.mirror = mirror_.true_angles(span.begin + (span.end - span.begin) / 2);
      at = span.end;
      spans.push_back(std::move(span));
    }
  }
  return spans;
}

}  // namespace raysteer::hal::mock
