// value: a steered rig as its board file draws it, and how far a real one may be off: start and prior of its solve.
#pragma once

#include "calib/model/steered_projector.hpp"

namespace raysteer::calib::steer {

/// One standard deviation each of what a workshop delivers (algorithms 4.5, 4.8). A board file's [tolerance] has fewer
/// numbers and no defaults, since files are the device's business too; host/rig/drawing.cpp alone makes one of it.
struct Tolerance {
  double axis_rad = 0.01745;
  double position_m = 0.0025;
  double zero_rad = 0.0262;
  double gain = 0.02;
  double quadratic = 0.003;
  double cubic = 0.003;
  double cross_talk = 0.001;
  double focal = 0.03;       ///< relative
  double aspect = 0.002;     ///< relative, fx against fy
  double centre = 0.015;     ///< of the focal length
  double distortion = 0.02;  ///< of k1; k2 alike
  double tangential = 0.001;
  double mount_rad = 0.0262;
  double mount_m = 0.02;
  double repeatability_rad = 20e-6;  ///< of the mirror from look to look, per axis
};

struct Drawing {
  model::SteeredProjector projector;
  Tolerance tolerance;
};

}  // namespace raysteer::calib::steer
