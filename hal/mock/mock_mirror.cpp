#include "hal/mock/mock_mirror.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/base/noise.hpp"
#include "hal/mock/device_number.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {
namespace {

/// Fine enough that the limiter's whole steps do not show: a fortieth of the loop's time constant.
std::chrono::nanoseconds step_of(const MirrorParameters& mirror) {
  const double fastest = std::max(mirror.axes[0].dynamics.natural, mirror.axes[1].dynamics.natural);
  return std::max(duration(std::min(200e-6, 0.1 / fastest)), std::chrono::nanoseconds(1'000));
}

Servo servo_of(const AxisParameters& axis) { return {axis.dynamics, axis.travel}; }

double rounded(double value, double step) { return step > 0 ? step * std::round(value / step) : value; }

constexpr double kRingHz = 37;

}  // namespace

MockMirror::MockMirror(const Clock& clock, const MirrorParameters& parameters, const Room& room, std::uint64_t seed,
                       Faults faults)
    : Mirror(clock, parameters.limits, parameters.settle),
      clock_(clock),
      parameters_(parameters),
      room_(room),
      seed_(seed),
      faults_(std::move(faults)),
      step_(step_of(parameters)),
      time_(clock.now()),
      servos_{servo_of(parameters.axes[0]), servo_of(parameters.axes[1])},
      samples_{{time_, {}}} {}

Status MockMirror::check_plugged(RigTime now) const {
  return faults_.lasting("unplug", now) ? Status(fail(RCode::kDeviceUnavailable, "the mirror's driver")) : ok();
}

Status MockMirror::do_aim(MirrorAngles target, RigTime at) {
  RAYSTEER_TRY(check_plugged(clock_.now()));
  if (faults_.take("refuse", at)) {
    return fail(RCode::kDeviceUnavailable, "the mirror's driver did not answer");
  }
  // A command that has not begun is replaced; one on its way through the delay is not.
  while (!commands_.empty() && commands_.back().at >= clock_.now() && commands_.back().at > time_) {
    commands_.pop_back();
  }
  const double delay = std::max(parameters_.axes[0].dynamics.delay_s, parameters_.axes[1].dynamics.delay_s);
  commands_.push_back({.target = {rounded(target.axis1.raw(), parameters_.axes[0].command_step),
                                  rounded(target.axis2.raw(), parameters_.axes[1].command_step)},
                       .at = at,
                       .effective = at + duration(delay)});
  return ok();
}

void MockMirror::begin(const Command& command) {
  Noise noise(seed_, DeviceNumber::kMirrorAim, aims_++);
  RestingError error{.begin = command.effective, .before = resting_error_at(command.effective), .after = {}};
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisErrors& errors = parameters_.axes[i].errors;
    const double way = command.target[i] - servos_[i].target();
    if (way != 0) {
      approach_[i] = way > 0 ? 1 : -1;
    }
    error.after[i] = errors.repeatability * noise.normal() + errors.hysteresis * approach_[i];
    servos_[i].command(command.target[i]);
  }
  resting_.set(command.effective, error);
}

void MockMirror::step_to(RigTime next) {
  const bool frozen = faults_.lasting("stuck", time_) || faults_.lasting("unplug", time_);
  const std::optional<double> slower = faults_.lasting("hot", time_);
  for (Servo& servo : servos_) {
    if (frozen) {
      servo.freeze();
    } else {
      servo.step(seconds(next - time_), slower.value_or(1));
    }
  }
  record(next);
}

void MockMirror::record(RigTime now) {
  time_ = now;
  const Pair position{servos_[0].position(), servos_[1].position()};
  const std::size_t count = samples_.size();
  // Two samples bound a rest; the second is moved while it lasts.
  if (count > 1 && samples_[count - 1].position == position && samples_[count - 2].position == position) {
    samples_.back().at = now;
  } else {
    samples_.push_back({now, position});
  }
}

void MockMirror::advance(RigTime now) {
  while (time_ < now) {
    const RigTime event = commands_.empty() ? RigTime::max() : commands_.front().effective;
    if (event <= time_) {
      begin(commands_.front());
      commands_.pop_front();
      continue;
    }
    if (servos_[0].at_rest() && servos_[1].at_rest()) {
      record(std::min(now, event));
      continue;
    }
    const RigTime next = std::min(time_ + step_, event);
    if (next > now) {
      break;
    }
    step_to(next);
  }
  const RigTime old = now - std::chrono::seconds(5);
  while (samples_.size() > 2 && samples_[1].at < old) {
    samples_.pop_front();
  }
  resting_.forget(old);
}

MockMirror::Pair MockMirror::position_at(RigTime at) const {
  const auto after = std::ranges::upper_bound(samples_, at, {}, &Sample::at);
  if (after == samples_.begin()) {
    return after->position;
  }
  if (after == samples_.end()) {
    return samples_.back().position;
  }
  const Sample& before = *(after - 1);
  const double part = seconds(at - before.at) / seconds(after->at - before.at);
  Pair between{};
  for (std::size_t i = 0; i < 2; ++i) {
    between[i] = before.position[i] + part * (after->position[i] - before.position[i]);
  }
  return between;
}

MockMirror::Pair MockMirror::resting_error_at(RigTime at) const {
  const RestingError& error = resting_.at(at);
  Pair now{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double gone = std::exp(-parameters_.axes[i].dynamics.natural * seconds(at - error.begin));
    now[i] = error.after[i] + (error.before[i] - error.after[i]) * gone;
  }
  return now;
}

MockMirror::Pair MockMirror::curve(Pair command) const {
  Pair angles{};
  for (std::size_t i = 0; i < 2; ++i) {
    const CommandCurve& c = parameters_.axes[i].curve;
    const double u = command[i] / c.half_range;
    const double other = command[1 - i] / parameters_.axes[1 - i].curve.half_range;
    angles[i] = c.half_range * (u * (1 + c.gain + u * (c.quadratic + u * c.cubic)) + c.cross_talk * other);
  }
  return angles;
}

MockMirror::Pair MockMirror::drifted(Pair angles, RigTime at) const {
  const double warm = parameters_.warm_up.since_start(seconds(at));
  const double kelvin = room_.kelvin(seconds(at));
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisErrors& errors = parameters_.axes[i].errors;
    const double drift = errors.warm_offset * warm + errors.room_offset * kelvin +
                         (errors.warm_gain * warm + errors.room_gain * kelvin) * angles[i];
    angles[i] += rounded(drift, parameters_.drift_step);
  }
  return angles;
}

MirrorAngles MockMirror::mean_angles(MirrorAngles command, RigTime at) const {
  const Pair angles = drifted(curve({command.axis1.raw(), command.axis2.raw()}), at);
  return {Radians(angles[0]), Radians(angles[1])};
}

MirrorAngles MockMirror::true_angles(RigTime at) const {
  Pair position = position_at(at);
  if (const std::optional<double> ring = faults_.lasting("ring", at)) {
    const double swing = *ring * std::sin(2 * std::numbers::pi * kRingHz * seconds(at));
    position[0] += swing;
    position[1] += swing;
  }
  Pair angles = drifted(curve(position), at);
  const Pair resting = resting_error_at(at);
  const double bump = faults_.lasting("bump", at).value_or(0);
  for (std::size_t i = 0; i < 2; ++i) {
    angles[i] += resting[i] + bump;
  }
  return {Radians(angles[0]), Radians(angles[1])};
}

bool MockMirror::moves(RigTime begin, RigTime end) const {
  if (faults_.lasting("ring", begin) || faults_.lasting("ring", end)) {
    return true;
  }
  const auto far = [&](const Pair& a, const Pair& b) {
    return std::abs(a[0] - b[0]) > parameters_.drift_step || std::abs(a[1] - b[1]) > parameters_.drift_step;
  };
  const Pair from = position_at(begin);
  const auto first = std::ranges::upper_bound(samples_, begin, {}, &Sample::at);
  for (auto sample = first; sample != samples_.end() && sample->at < end; ++sample) {
    if (far(sample->position, from)) {
      return true;
    }
  }
  return far(position_at(end), from) || far(resting_error_at(begin), resting_error_at(end));
}

Result<MirrorReading> MockMirror::do_feedback() {
  const RigTime now = clock_.now();
  RAYSTEER_TRY(check_plugged(now));
  Noise noise(seed_, DeviceNumber::kMirrorSensor, readings_++);
  if (faults_.take("nan", now)) {
    const Radians none(std::numeric_limits<double>::quiet_NaN());
    return MirrorReading{.angles = {none, none}, .stamp = now};
  }
  Pair position = position_at(now);
  const std::optional<double> ring = faults_.lasting("ring", now);
  const double off = faults_.lasting("sensor", now).value_or(0);
  for (std::size_t i = 0; i < 2; ++i) {
    const AxisSensor& sensor = parameters_.axes[i].sensor;
    const double swing = ring ? *ring * std::sin(2 * std::numbers::pi * kRingHz * seconds(now)) : 0;
    position[i] = (1 + sensor.gain) * (position[i] + swing) + sensor.offset + off + sensor.noise * noise.normal();
    if (!(std::abs(position[i]) <= sensor.rail)) {
      return fail(RCode::kMirrorSensor, "the sensor of axis " + std::to_string(i + 1) + " is at its rail");
    }
  }
  if (faults_.take("rail", now)) {
    return fail(RCode::kMirrorSensor, "the sensor of axis 1 is at its rail");
  }
  return MirrorReading{.angles = {Radians(position[0]), Radians(position[1])}, .stamp = now};
}

}  // namespace raysteer::hal::mock
