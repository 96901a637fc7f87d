#include "hal/mock/mock_trigger.hpp"

#include <algorithm>

#include "hal/base/noise.hpp"
#include "hal/mock/device_number.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {

MockTrigger::MockTrigger(const Clock& clock, const TriggerParameters& parameters, std::uint64_t seed, Faults faults,
                         Sink cameras)
    : Trigger(clock),
      clock_(clock),
      parameters_(parameters),
      seed_(seed),
      faults_(std::move(faults)),
      cameras_(std::move(cameras)) {}

void MockTrigger::schedule(RigTime at) {
  Noise noise(seed_, DeviceNumber::kTrigger, asked_++);
  if (faults_.take("miss", at)) {
    return;
  }
  const double jitter = parameters_.jitter_s * std::clamp(noise.normal(), -3.0, 3.0);
  double wait = std::max(0.0, parameters_.latency_s + jitter);
  if (const std::optional<double> late = faults_.take("late", at)) {
    wait += *late;
  }
  const auto insert = [this](RigTime edge) { scheduled_.insert(std::ranges::upper_bound(scheduled_, edge), edge); };
  insert(at + duration(wait));
  if (const std::optional<double> bounce = faults_.take("double", at)) {
    insert(at + duration(wait + *bounce));
  }
}

void MockTrigger::pulse(RigTime at) {
  if (armed_ && external_) {
    schedule(at);
  }
}

void MockTrigger::advance(RigTime now) {
  while (!scheduled_.empty() && scheduled_.front() <= now) {
    const RigTime edge = scheduled_.front();
    scheduled_.erase(scheduled_.begin());
    if (faults_.lasting("unplug", edge)) {
      continue;
    }
    constexpr std::size_t kKept = 4'096;
    unread_.push_back({.number = seen_++, .stamp = edge});
    if (unread_.size() > kKept) {
      unread_.pop_front();
    }
    cameras_(edge);
  }
}

Status MockTrigger::check_plugged(RigTime now) const {
  return faults_.lasting("unplug", now) ? Status(fail(RCode::kDeviceUnavailable, "the trigger line")) : ok();
}

Status MockTrigger::do_arm(TriggerSource source) {
  scheduled_.clear();
  unread_.clear();
  seen_ = 0;
  armed_ = false;
  RAYSTEER_TRY(check_plugged(clock_.now()));
  external_ = source == TriggerSource::kExternal;
  armed_ = true;
  return ok();
}

Status MockTrigger::do_disarm() {
  RAYSTEER_TRY(check_plugged(clock_.now()));
  armed_ = false;
  scheduled_.clear();
  return ok();
}

Status MockTrigger::do_fire(RigTime at) {
  RAYSTEER_TRY(check_plugged(clock_.now()));
  schedule(at);
  return ok();
}

Result<std::uint64_t> MockTrigger::do_count() {
  RAYSTEER_TRY(check_plugged(clock_.now()));
  return seen_;
}

Result<std::vector<TriggerEdge>> MockTrigger::do_edges() {
  RAYSTEER_TRY(check_plugged(clock_.now()));
  std::vector<TriggerEdge> edges(unread_.begin(), unread_.end());
  unread_.clear();
  return edges;
}

}  // namespace raysteer::hal::mock
