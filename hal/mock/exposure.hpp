// value: what one camera's shutter let in: who lit the scene with what, when, and where the mirror stood.
//
// The mock camera knows no optics. It collects this from the mock projector, mirror and interlock and hands it to a
// scene function, which answers with electrons; noise, saturation and quantisation are the camera's.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/time.hpp"
#include "hal/base/units.hpp"
#include "hal/mirror.hpp"
#include "hal/stereo_camera.hpp"

namespace raysteer::hal::mock {

/// What is on the panel: 8-bit codes and the light each gives. Shared and never changed.
struct PanelPicture {
  int width = 0;
  int height = 0;
  std::optional<Axis> along;          ///< kX: all rows are alike; kY: all columns; nothing: neither
  std::vector<std::uint8_t> profile;  ///< with `along`: the codes along that axis
  Image<std::uint8_t> pixels;         ///< without
  std::array<float, 256> response{};  ///< light of each code: 0 to 1, black level included

  float light(int x, int y) const {
    return response[!along ? pixels(x, y) : profile[static_cast<std::size_t>(*along == Axis::kX ? x : y)]];
  }
};

/// A stretch of time in which nothing changed.
struct LightSpan {
  RigTime begin{};
  RigTime end{};
  std::shared_ptr<const PanelPicture> picture;  ///< nullptr: light off
  int first_row = 0;                            ///< panel rows this is true of: a torn frame is two spans of one time
  int end_row = 0;
  double power = 1;     ///< of the lamp, 1 when warm
  ProjectorPx drift{};  ///< the picture stands so far from where it stood at rig time 0
  MirrorAngles mirror;  ///< where the mirror truly is, mechanical, in the middle of the span
};

/// One eye's exposure. Spans do not overlap except torn ones; gaps are dark.
struct Exposure {
  Eye eye = Eye::kLeft;
  RigTime begin{};
  std::chrono::nanoseconds duration{};
  std::vector<LightSpan> light;
};

/// Mean electrons of each pixel of that eye, before noise and saturation: the truth a camera looks at.
/// Same exposure, same pixels, bit for bit, whatever the number of threads inside.
using SceneFunction = std::function<Image<float>(const Exposure&)>;

}  // namespace raysteer::hal::mock
