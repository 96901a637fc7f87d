// bound to whoever advances the rig: two pretend cameras on one trigger line and one bus.
#pragma once

#include <array>
#include <string>

#include "hal/mock/mock_eye.hpp"
#include "hal/stereo_camera.hpp"

namespace raysteer::hal::mock {

struct StereoParameters {
  std::array<EyeParameters, 2> eyes;
  std::array<std::string, 2> bound;  ///< serials the board file names; empty: any
  StereoCamera::Pairing pairing;
  CameraClock clock;
  double bus_bytes_per_s = 900e6;
  int threads = 1;  ///< that noise is drawn with
};

class MockStereoCamera final : public StereoCamera {
 public:
  MockStereoCamera(const Clock& clock, const StereoParameters& parameters, std::uint64_t seed,
                   std::span<const Fault> faults, const MockEye::Light& light, const SceneFunction& scene);

  void edge(RigTime at);
  void advance(RigTime now);
  const StereoParameters& parameters() const { return parameters_; }

 private:
  Result<CameraInfo> do_info(Eye eye) override;
  Result<CameraSettings> do_configure(Eye eye, const CameraSettings& settings) override;
  Status do_start() override;
  Status do_stop() override;
  Result<std::optional<EyeFrame>> do_next_frame(Eye eye) override;

  /// The camera that answers for this eye today.
  MockEye& at(Eye eye);
  Status check_plugged(Eye eye);

  const Clock& clock_;
  StereoParameters parameters_;
  Faults faults_;
  std::array<MockEye, 2> eyes_;
};

}  // namespace raysteer::hal::mock
