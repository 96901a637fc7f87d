// A pretend rig small enough for unit tests: a grey wall that fills the view, lit by the mean of the panel.
#pragma once

#include <memory>

#include "hal/mock/mock_rig.hpp"
#include "hal/mock/seconds.hpp"

namespace raysteer::hal::mock {

inline constexpr double kWallElectronsPerSecond = 500e3;  ///< of a lit pixel; 5,000 in 10 ms, half the well
inline constexpr int kWhiteCode = 128;

/// Mean electrons of a wall that shows each camera pixel the panel pixel of the same number, modulo the panel.
inline Image<float> wall(const Exposure& exposure, int width, int height) {
  Image<float> electrons(width, height);
  for (const LightSpan& span : exposure.light) {
    const double weight = kWallElectronsPerSecond * seconds(span.end - span.begin) * span.power;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const int row = y % span.picture->height;
        if (row >= span.first_row && row < span.end_row) {
          electrons(x, y) += static_cast<float>(weight * span.picture->light(x % span.picture->width, row));
        }
      }
    }
  }
  return electrons;
}

inline RigParameters small_parameters() {
  RigParameters rig;
  rig.mirror = *mirror_preset("galvo");
  rig.projector.panel = {.width = 64, .height = 40, .frame_period = std::chrono::nanoseconds(16'666'667)};
  const char* serials[] = {"L1", "R1"};
  for (std::size_t i = 0; i < 2; ++i) {
    rig.cameras.eyes[i].info.serial = serials[i];
    rig.cameras.eyes[i].info.width = 48;
    rig.cameras.eyes[i].info.height = 32;
    rig.cameras.bound[i] = serials[i];
  }
  return rig;
}

inline std::unique_ptr<MockRig> small_rig(RigParameters parameters = small_parameters()) {
  const CameraInfo info = parameters.cameras.eyes[0].info;
  auto rig =
      MockRig::make(parameters, [info](const Exposure& exposure) { return wall(exposure, info.width, info.height); });
  RAYSTEER_CHECK(rig.has_value());
  return std::move(*rig);
}

inline PatternSequence white_and_black() {
  return {
      .panel_width = 64, .panel_height = 40, .blocks = {{.kind = PatternKind::kWhite}, {.kind = PatternKind::kBlack}}};
}

inline void run_for(MockRig& rig, std::chrono::nanoseconds time) { rig.advance_to(rig.now() + time); }

}  // namespace raysteer::hal::mock
