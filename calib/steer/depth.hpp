// Did the looks show depth? Without a board a flat scene leaves the cameras' focal lengths open, however well all
// residuals fit (algorithms 5.3), and so do two eyes in one place.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calib/steer/plane_or_depth.hpp"
#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {

struct Depth {
  Gric all;  ///< of all looks as one: several planes are depth, though each look is flat
  std::vector<std::string> flat_looks;
  double angle_rad = 0;  ///< at which the eyes' rays meet, median
};

/// Left against right eye, on pixels freed from the cameras' lenses. `noise`: standard deviations are taken as this
/// many times what is stated. Pairs of looks are not compared: they share no points, and where the mirror only turns
/// the picture the eyes still see depth.
Depth depth_of(std::span<const Look> looks, const model::Rig& cameras, double noise = 1);

/// kTooLittleParallax: the eyes' rays meet at less than a third of a degree, so that nothing shows depth;
/// kSceneTooFlat: one plane explains what both eyes saw.
Status check_depth(const Depth& depth);

/// A focal length that stays unknown by more than this share, one standard deviation, is no answer.
inline constexpr double kMostFocalSigma = 2e-3;

/// The above, and kSceneTooFlat where a little depth leaves a focal length open; the note names the flat looks.
Status check_depth(const Depth& depth, const Solution& solution);

}  // namespace raysteer::calib::steer
