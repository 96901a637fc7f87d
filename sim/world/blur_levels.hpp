// pure: widths of blur in steps of 4 %, so that a pixel's blur fits one byte and pictures are blurred once per step.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace raysteer::sim::world {

inline constexpr double kLeastBlurPx = 0.3;  ///< standard deviation, panel px; no lens is sharper
inline constexpr double kBlurStep = 1.04;    ///< a level is off by 2 % at most: 0.2 % of a period-16 contrast
inline constexpr int kBlurLevels = 160;      ///< up to 160 px

inline std::uint8_t blur_level(double sigma_px) {
  static const double per_log = 1 / std::log(kBlurStep);
  const double level = std::log(std::max(sigma_px, kLeastBlurPx) / kLeastBlurPx) * per_log;
  return static_cast<std::uint8_t>(std::min(level + 0.5, kBlurLevels - 1.0));
}

inline double blur_sigma(int level) { return kLeastBlurPx * std::pow(kBlurStep, level); }

}  // namespace raysteer::sim::world
