#include "hal/mock/mock_stereo_camera.hpp"

#include <cstdio>

#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {

MockStereoCamera::MockStereoCamera(const Clock& clock, const StereoParameters& parameters, std::uint64_t seed,
                                   std::span<const Fault> faults, const MockEye::Light& light,
                                   const SceneFunction& scene)
    : StereoCamera(parameters.bound, parameters.pairing),
      clock_(clock),
      parameters_(parameters),
      faults_(faults, "cameras"),
      eyes_{MockEye(Eye::kLeft, parameters.eyes[0], parameters.clock, seed, Faults(faults, "left"), light, scene,
                    parameters.threads),
            MockEye(Eye::kRight, parameters.eyes[1], parameters.clock, seed, Faults(faults, "right"), light, scene,
                    parameters.threads)} {}

MockEye& MockStereoCamera::at(Eye eye) {
  const bool swapped = faults_.lasting("swap", clock_.now()).has_value();
  return eyes_[(eye == Eye::kLeft) != swapped ? 0 : 1];
}

Status MockStereoCamera::check_plugged(Eye eye) {
  if (at(eye).plugged(clock_.now())) {
    return ok();
  }
  return fail(RCode::kDeviceUnavailable,
              eye == Eye::kLeft ? "the left camera is unplugged" : "the right camera is unplugged");
}

Result<CameraInfo> MockStereoCamera::do_info(Eye eye) {
  RAYSTEER_TRY(check_plugged(eye));
  return at(eye).info();
}

Result<CameraSettings> MockStereoCamera::do_configure(Eye eye, const CameraSettings& settings) {
  RAYSTEER_TRY(check_plugged(eye));
  return at(eye).configure(settings, clock_.now());
}

Status MockStereoCamera::do_start() {
  double needed = 0;
  for (const Eye eye : kEyes) {
    RAYSTEER_TRY(check_plugged(eye));
    const CameraInfo& info = at(eye).info();
    needed += info.width * static_cast<double>(info.height) * (info.bits > 8 ? 2 : 1) / seconds(info.least_period);
  }
  const double available = parameters_.bus_bytes_per_s * faults_.lasting("bandwidth", clock_.now()).value_or(1);
  if (needed > available) {
    char note[120];
    std::snprintf(note, sizeof note, "both cameras need %.0f MB/s at their least period, the bus carries %.0f MB/s",
                  1e-6 * needed, 1e-6 * available);
    return fail(RCode::kBandwidth, note);
  }
  for (MockEye& eye : eyes_) {
    eye.start(clock_.now());
  }
  return ok();
}

Status MockStereoCamera::do_stop() {
  for (MockEye& eye : eyes_) {
    eye.stop();
  }
  for (const Eye eye : kEyes) {
    RAYSTEER_TRY(check_plugged(eye));
  }
  return ok();
}

Result<std::optional<EyeFrame>> MockStereoCamera::do_next_frame(Eye eye) {
  std::optional<EyeFrame> frame = at(eye).next_frame(clock_.now());
  if (!frame) {
    RAYSTEER_TRY(check_plugged(eye));
  }
  return frame;
}

void MockStereoCamera::edge(RigTime at) {
  for (MockEye& eye : eyes_) {
    eye.edge(at);
  }
}

void MockStereoCamera::advance(RigTime now) {
  for (MockEye& eye : eyes_) {
    eye.advance(now);
  }
}

}  // namespace raysteer::hal::mock
