#include <chrono>
#include <cmath>

#include "firmware/rig/devices.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::firmware::rig {
namespace {

using hal::mock::RigParameters;
using std::chrono::duration_cast;
using std::chrono::microseconds;

microseconds micros(double seconds) { return duration_cast<microseconds>(hal::mock::duration(seconds)); }

hal::MirrorAngles angles(const std::array<double, 2>& rad) { return {Radians(rad[0]), Radians(rad[1])}; }

Result<hal::mock::MirrorParameters> mirror(const proto::board::Mirror& drawn, const Pretend& pretend) {
  Result<hal::mock::MirrorParameters> preset = hal::mock::mirror_preset(drawn.preset);
  if (!preset) {
    return preset;
  }
  preset->limits = {angles(drawn.least_rad), angles(drawn.most_rad)};
  preset->settle = {Radians(drawn.settle_tolerance_rad), micros(drawn.settle_window_s)};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    preset->axes[axis].curve = pretend.curves[axis];
  }
  return preset;
}

hal::mock::ProjectorParameters projector(const proto::board::Projector& drawn) {
  hal::mock::ProjectorParameters parameters;
  parameters.panel = {
      .width = drawn.width, .height = drawn.height, .frame_period = hal::mock::duration(1 / drawn.frame_rate_hz)};
  parameters.gamma = drawn.gamma;
  return parameters;
}

hal::mock::EyeParameters eye(const proto::board::Camera& drawn) {
  hal::mock::EyeParameters eye;
  eye.info = {.serial = drawn.serial,
              .width = drawn.width,
              .height = drawn.height,
              .bits = drawn.bits,
              .least_exposure = micros(drawn.least_exposure_s),
              .most_exposure = micros(drawn.most_exposure_s),
              .most_gain_db = eye.info.most_gain_db,
              .least_period = micros(drawn.least_period_s)};
  eye.sensor.bits = drawn.bits;
  eye.sensor.full_well_e = drawn.full_well_e;
  eye.sensor.read_noise_e = drawn.read_noise_e;
  return eye;
}

hal::mock::Fault fault(const proto::board::Fault& asked) {
  return {.device = asked.device,
          .what = asked.what,
          .from = RigTime(hal::mock::duration(asked.at_s)),
          .times = asked.times,
          .amount = asked.amount};
}

}  // namespace

Result<RigParameters> mock_parameters(const proto::board::Board& board, const Pretend& pretend) {
  if (board.cameras.size() != 2) {
    return fail(RCode::kBadValue,
                "board '" + board.name + "': two cameras are needed, got " + std::to_string(board.cameras.size()));
  }
  RigParameters parameters;
  parameters.seed = pretend.seed;
  Result<hal::mock::MirrorParameters> made = mirror(board.mirror, pretend);
  if (!made) {
    return with_context(std::move(made).error(), "board '" + board.name + "'");
  }
  parameters.mirror = *std::move(made);
  parameters.projector = projector(board.projector);
  if (board.projector.kind == proto::board::ProjectorKind::kTriggerMaster) {
    parameters.player.emplace();
  }
  for (std::size_t i = 0; i < 2; ++i) {
    parameters.cameras.eyes[i] = eye(board.cameras[i]);
    parameters.cameras.bound[i] = board.cameras[i].serial;
  }
  parameters.cameras.threads = pretend.threads;
  for (const auto* asked : {&board.faults, &pretend.faults}) {
    for (const proto::board::Fault& each : *asked) {
      parameters.faults.push_back(fault(each));
    }
  }
  return parameters;
}

}  // namespace raysteer::firmware::rig
