// value: what devices of a known rig would measure of a target, with Gaussian noise of known sigma: for the statistics
// of solvers, where rendering and detecting images would cost too much and add errors of their own.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/synth/noise.hpp"
#include "calib/target/target_geometry.hpp"

namespace raysteer::calib::synth {

/// How a target is waved (algorithms 1.3: three distances, tilts about both axes, all over the image).
struct TargetPlan {
  int views = 20;
  double distance_m = 1.0;  ///< of the target's middle; held at 0.8, 1 and 1.25 times this
  double tilt_rad = 0.55;   ///< largest tilt; every third view is nearly frontal
  double margin_px = 8;     ///< corners stay this far inside every camera's image (on the panel: of the projector)
  bool on_panel = false;    ///< the projector, if there is one, must reach every corner too
};

/// Poses T_rig_target at which every camera sees every corner. Fewer than plan.views when the target hardly fits.
std::vector<model::Pose> target_poses(const model::Rig& rig, const TargetSpec& target, const TargetPlan& plan,
                                      std::uint64_t seed);

/// A camera pixel on the target and the projector coordinate decoded there.
struct PanelPixel {
  int camera = 0;
  Eigen::Vector2d q = Eigen::Vector2d::Zero();  ///< camera px: a pixel's centre, without error
  Eigen::Vector2d x = Eigen::Vector2d::Zero();  ///< projector px
  double sigma_px = 0;                          ///< of x, per coordinate
};

struct MeasurementNoise {
  double corner_px = 0.1;  ///< sigma per coordinate
  double panel_px = 0.1;
};

/// One pose of the target as every device saw it.
struct TargetView {
  model::Pose T_rig_target;                          ///< the truth
  std::vector<std::vector<target::Corner>> corners;  ///< per device; none for a projector
  std::vector<PanelPixel> pixels;                    ///< first camera; with a projector only
};

/// Measures corners in every camera and, on a grid of about `panel_pixels` camera pixels inside the corners,
/// projector coordinates.
TargetView observe(const model::Rig& rig, const TargetSpec& target, const model::Pose& T_rig_target,
                   const MeasurementNoise& sigma, Noise& noise, int panel_pixels = 300);

}  // namespace raysteer::calib::synth
