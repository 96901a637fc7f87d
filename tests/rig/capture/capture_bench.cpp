#include "tests/rig/capture/capture_bench.hpp"

#include <algorithm>

namespace raysteer::support {

using firmware::capture::Capture;
using firmware::capture::State;

CaptureBench::CaptureBench(Kind kind, std::uint64_t rig_seed) {
  parameters.seed = rig_seed;
  parameters.tick = std::chrono::microseconds(500);
  parameters.projector.panel = {.width = 64, .height = 40, .frame_period = std::chrono::nanoseconds(16'666'667)};
  if (kind == Kind::kTriggerMaster) {
    parameters.player.emplace();
  }
  for (hal::mock::EyeParameters& eye : parameters.cameras.eyes) {
    eye.info.width = plane.width;
    eye.info.height = plane.height;
  }
  parameters.cameras.eyes[0].info.serial = "one";
  parameters.cameras.eyes[1].info.serial = "two";
  plan.name = "bench";
  add_look("straight", 0.01, -0.02);
  sequence = *proto::plan::pattern_set("default", 64, 40);
}

void CaptureBench::add_look(const std::string& name, double axis1, double axis2) {
  plan.looks.push_back({.name = name, .mirror_rad = {axis1, axis2}, .prepare = {}});
}

void CaptureBench::fault(const std::string& device, const std::string& what, double at_s, int times, double amount) {
  parameters.faults.push_back({.device = device,
                               .what = what,
                               .from = RigTime(std::chrono::nanoseconds(std::llround(at_s * 1e9))),
                               .times = times,
                               .amount = amount});
}

Status CaptureBench::make() {
  auto made = hal::mock::MockRig::make(parameters, plane);
  if (!made) {
    return std::move(made).error();
  }
  rig = std::move(*made);
  rig->advance_to(now);
  auto begun = Capture::make(rig->rig(), plan, sequence, options, *sink, log);
  if (!begun) {
    return std::move(begun).error();
  }
  capture.emplace(std::move(*begun));
  return ok();
}

State CaptureBench::run(double most_s) {
  const RigTime end = now + std::chrono::nanoseconds(std::llround(most_s * 1e9));
  while (capture->tick(now) == State::kRunning && now < end) {
    now += std::chrono::milliseconds(1);
    rig->advance_to(now);
  }
  return capture->state();
}

double CaptureBench::run_to(const std::string& event, double most_s) {
  const RigTime end = now + std::chrono::nanoseconds(std::llround(most_s * 1e9));
  while (now < end) {
    const std::size_t before = events.size();
    const State state = capture->tick(now);
    if (std::any_of(events.begin() + static_cast<std::ptrdiff_t>(before), events.end(),
                    [&](const std::string& line) { return line.starts_with(event); })) {
      return seconds();
    }
    if (state != State::kRunning) {
      break;
    }
    now += std::chrono::milliseconds(1);
    rig->advance_to(now);
  }
  return -1;
}

bool CaptureBench::said(const std::string& part) const {
  return std::ranges::any_of(events, [&](const std::string& line) { return line.find(part) != std::string::npos; });
}

std::string CaptureBench::story() const {
  std::string text;
  for (const std::string& line : events) {
    text += line + "\n";
  }
  return text;
}

}  // namespace raysteer::support
