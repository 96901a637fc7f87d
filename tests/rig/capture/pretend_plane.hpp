// pure: a scene cheap enough for tests: a wall whose every camera pixel sees a fixed place of the panel, ambient light
// that may flicker, and someone who may walk in.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "hal/mock/exposure.hpp"

namespace raysteer::support {

struct PretendPlane {
  int width = 64;
  int height = 48;
  double white_e_per_s = 120e3;  ///< electrons of a pixel under white
  double ambient_e_per_s = 20e3;
  double flicker_hz = 100;
  double flicker = 0;  ///< amplitude over mean of the ambient light
  /// From then until then a quarter of the view is dark.
  std::optional<std::array<RigTime, 2>> somebody;
  double shift_per_rad = 200;  ///< panel px that the picture moves when the mirror stands off rest

  /// Electrons; what a mock camera asks of a scene.
  Image<float> operator()(const hal::mock::Exposure& exposure) const {
    Image<float> electrons(width, height);
    const double ambient = ambient_in(exposure);
    const auto seconds = [](std::chrono::nanoseconds time) { return static_cast<double>(time.count()) * 1e-9; };
    const bool occupied = somebody && exposure.begin >= (*somebody)[0] && exposure.begin < (*somebody)[1];
    const double eye = exposure.eye == hal::Eye::kLeft ? 0 : 3;
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const double albedo = (occupied && u < width / 4 ? 0.1 : 1) * (0.7 + 0.3 * std::cos(0.21 * u + 0.13 * v));
        double sum = ambient;
        for (const hal::mock::LightSpan& span : exposure.light) {
          const double moved = shift_per_rad * (span.mirror.axis1.raw() + span.mirror.axis2.raw());
          sum += white_e_per_s * seconds(span.end - span.begin) * span.power *
                 lit(span, 3 + 0.9 * u + eye + moved, -3 + 0.9 * v);
        }
        electrons(u, v) = static_cast<float>(albedo * sum);
      }
    }
    return electrons;
  }

 private:
  // Area of 0.9 panel pixels, by nine samples.
  static double lit(const hal::mock::LightSpan& span, double x, double y) {
    double sum = 0;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int column = static_cast<int>(std::lround(x + 0.3 * dx));
        const int row = static_cast<int>(std::lround(y + 0.3 * dy));
        const bool there = column >= 0 && column < span.picture->width && row >= span.first_row && row < span.end_row;
        sum += there ? span.picture->light(column, row) / 9.0 : 0;
      }
    }
    return sum;
  }

  double ambient_in(const hal::mock::Exposure& exposure) const {
    const double turn = 2 * std::numbers::pi * flicker_hz;
    const double begin = static_cast<double>(exposure.begin.time_since_epoch().count()) * 1e-9;
    const double length = static_cast<double>(exposure.duration.count()) * 1e-9;
    return ambient_e_per_s * (length + flicker / turn * (std::sin(turn * (begin + length)) - std::sin(turn * begin)));
  }
};

}  // namespace raysteer::support
