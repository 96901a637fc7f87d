#include "firmware/capture/capture.hpp"

#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "firmware/capture/engine.hpp"

namespace raysteer::firmware::capture {
namespace {

// The mirror would refuse it too, but only when it is this look's turn.
Status check_look(const proto::plan::PlannedLook& look, const hal::MirrorLimits& limits) {
  const std::array least{limits.least.axis1.raw(), limits.least.axis2.raw()};
  const std::array most{limits.most.axis1.raw(), limits.most.axis2.raw()};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double angle = look.mirror_rad[axis];
    if (!(angle >= least[axis] && angle <= most[axis])) {
      return fail(RCode::kMirrorOutOfRange, "look '" + look.name + "': axis " + std::to_string(axis + 1) + " at " +
                                                std::to_string(angle) + " rad, allowed are " +
                                                std::to_string(least[axis]) + " to " + std::to_string(most[axis]));
    }
  }
  return ok();
}

Status check_plan(const proto::plan::Plan& plan, const hal::MirrorLimits& limits) {
  if (plan.looks.empty()) {
    return fail(RCode::kBadValue, "plan '" + plan.name + "' has no looks; expected at least one");
  }
  std::set<std::string> names;
  for (const proto::plan::PlannedLook& look : plan.looks) {
    if (!names.insert(look.name).second) {
      return fail(RCode::kBadValue, "plan '" + plan.name + "' has two looks named '" + look.name + "'");
    }
    RAYSTEER_TRY(check_look(look, limits));
  }
  return ok();
}

Status check_options(const Options& options) {
  if (options.most_retakes < 0 || options.longest_latency_frames < 1 || options.settle_timeout.count() <= 0 ||
      options.wanted_exposure.count() <= 0) {
    return fail(RCode::kBadValue, "capture options: retakes from 0, latency from 1 frame, times longer than 0");
  }
  return ok();
}

}  // namespace

Result<Capture> Capture::make(const hal::Rig& rig, proto::plan::Plan plan, PatternSequence sequence, Options options,
                              Sink& sink, const EventLog& log) {
  RAYSTEER_TRY(check_options(options));
  RAYSTEER_TRY(check_plan(plan, rig.mirror.limits()));
  RAYSTEER_TRY(check(sequence));
  const hal::ProjectorPanel& panel = rig.projector.panel();
  if (sequence.panel_width != panel.width || sequence.panel_height != panel.height) {
    return fail(RCode::kPanelSize, "the sequence is for a panel of " + std::to_string(sequence.panel_width) + " x " +
                                       std::to_string(sequence.panel_height) + " px, the projector has " +
                                       std::to_string(panel.width) + " x " + std::to_string(panel.height));
  }
  if (sequence.blocks.empty()) {
    return fail(RCode::kBadSequence, "the sequence has no patterns");
  }
  return Capture(std::make_unique<Engine>(rig, std::move(plan), std::move(sequence), std::move(options), sink, log));
}

Capture::Capture(std::unique_ptr<Engine> engine) : engine_(std::move(engine)) {}
Capture::Capture(Capture&&) noexcept = default;
Capture& Capture::operator=(Capture&&) noexcept = default;
Capture::~Capture() = default;

State Capture::tick(RigTime now) { return engine_->tick(now); }
void Capture::go_on(RigTime now) { engine_->go_on(now); }
State Capture::state() const { return engine_->state(); }
const std::string& Capture::prepare() const { return engine_->prepare(); }
const std::optional<Error>& Capture::error() const { return engine_->error(); }
Progress Capture::progress() const { return engine_->progress(); }
const Findings& Capture::findings() const { return engine_->findings(); }

}  // namespace raysteer::firmware::capture
