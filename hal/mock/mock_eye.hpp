// bound to whoever advances the rig: one camera of a pair.
#pragma once

#include <deque>
#include <functional>
#include <optional>

#include "hal/mock/exposure.hpp"
#include "hal/mock/fault.hpp"
#include "hal/mock/sensor.hpp"
#include "hal/stereo_camera.hpp"

namespace raysteer::hal::mock {

struct EyeParameters {
  CameraInfo info{.serial = "mock",
                  .width = 2448,
                  .height = 2048,
                  .bits = 8,
                  .least_exposure = std::chrono::microseconds(20),
                  .most_exposure = std::chrono::microseconds(1'000'000),
                  .most_gain_db = 24,
                  .least_period = std::chrono::microseconds(12'500)};
  SensorParameters sensor;  ///< `bits` is taken from `info`
  std::chrono::nanoseconds trigger_delay{5'000};
  std::chrono::nanoseconds arrival{14'000'000};  ///< from an exposure's end to the computer: read-out and transfer
  double stamp_noise_s = 0.5e-6;                 ///< one standard deviation
};

/// The clock both cameras stamp with: camera time = offset + (1 + drift) rig time.
struct CameraClock {
  double offset_s = 1'000;
  double drift = 15e-6;
  CameraTime at(RigTime rig) const;
};

class MockEye {
 public:
  using Light = std::function<std::vector<LightSpan>(RigTime begin, RigTime end)>;
  MockEye(Eye eye, const EyeParameters& parameters, const CameraClock& clock, std::uint64_t seed, Faults faults,
          Light light, SceneFunction scene, int threads);

  const CameraInfo& info() const { return parameters_.info; }
  CameraSettings configure(const CameraSettings& settings, RigTime now);
  void start(RigTime now);
  void stop();
  void edge(RigTime at);
  void advance(RigTime now);
  /// The oldest frame that has arrived; it is rendered here.
  std::optional<EyeFrame> next_frame(RigTime now);
  bool plugged(RigTime now) const { return !faults_.lasting("unplug", now); }

  std::uint64_t exposures() const { return exposures_; }

 private:
  struct Pending {
    Exposure exposure;
    bool over = false;  ///< its light has been collected
    RigTime arrives{};
    std::uint64_t number = 0;  ///< of all exposures of this device: the counter of its noise
    double times = 1;          ///< light, by a fault
    int blur = 0;
    double damaged = 0;  ///< part of its rows
    EyeFrame frame;      ///< all but the pixels
  };

  void begin_exposure(RigTime at);

  Eye eye_;
  EyeParameters parameters_;
  CameraClock clock_;
  std::uint64_t seed_;
  Faults faults_;
  Light light_;
  SceneFunction scene_;
  int threads_;

  CameraSettings settings_;
  bool streaming_ = false;
  double automatic_ = 0;  ///< exposure is so many times what was asked; 0: it is fixed
  RigTime ready_{};       ///< for the next exposure
  std::uint32_t sequence_ = 0;
  std::uint64_t exposures_ = 0;
  std::deque<Pending> pending_;
};

}  // namespace raysteer::hal::mock
