// value: a solved rig, with every residual and what became of every view.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "hal/base/rcode.hpp"

namespace raysteer::calib::solve {

/// One measured corner against the model.
struct Residual {
  int view = 0;           ///< index into Solution::views
  int id = 0;             ///< corner of the target
  Eigen::Vector2d q;      ///< measured, px of the device
  Eigen::Vector2d error;  ///< model minus measured, px
  bool kept = true;       ///< false: farther off than 4 sigma, or in a view left out
};

/// One decoded pixel against the model, on the panel.
struct PixelResidual {
  int view = 0;
  Eigen::Vector2d q;      ///< camera px
  Eigen::Vector2d x;      ///< projector px, measured
  Eigen::Vector2d error;  ///< model minus measured, projector px
  bool kept = true;
};

/// How well one device fits. RMS are two-dimensional: sqrt(mean(dx^2 + dy^2)).
struct DeviceFit {
  std::string name;
  double rms_px = 0;    ///< kept corners
  double sigma_px = 0;  ///< per coordinate, as the solve weighted it (floor 0.05 px)
  int corners_seen = 0;
  int corners_kept = 0;
  std::vector<Residual> residuals;
  double kept_share() const { return corners_seen == 0 ? 0 : static_cast<double>(corners_kept) / corners_seen; }
};

/// What became of one view.
struct ViewFit {
  std::string name;
  bool used = true;
  RCode why = RCode::kNone;    ///< when not used
  std::string why_note;        ///< "its corners miss the others' calibration by 14.2 px"
  model::Pose T_rig_target;    ///< where the target was
  std::vector<double> rms_px;  ///< per device, two-dimensional; 0 where not seen
  double tilt_rad = 0;         ///< between the target's normal and the first camera's axis
  double distance_m = 0;       ///< to the target's middle
};

/// A lens model that was tried, and how it did on corners it had not seen.
struct LensTrial {
  std::string device;
  model::LensModel lens{};
  double held_out_px = 0;  ///< RMS, two-dimensional
  bool monotonic = true;
  bool chosen = false;
};

struct Solution {
  model::Rig rig;  ///< with covariance, from our own Jacobian
  /// Sag of the target's middle against its edges, along columns and rows, metres; and its sigma.
  Eigen::Vector2d sag_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d sag_sigma_m = Eigen::Vector2d::Zero();
  std::vector<DeviceFit> devices;
  std::vector<ViewFit> views;
  std::vector<LensTrial> lenses;

  double rms_px = 0;              ///< kept corners of all devices, each corner of equal weight, two-dimensional
  double all_corners_rms_px = 0;  ///< the same over every corner of the views used, kept or not
  /// RMS of a plain fit to every corner of the views used, none left out, all of equal weight: what other tools report
  double plain_fit_rms_px = 0;
  double whitened_rms = 0;  ///< 1 when the noise is what the solve took it to be
  int iterations = 0;

  // With a projector:
  std::vector<PixelResidual> pixels;
  double pixel_rms_px = 0;  ///< single decoded pixels, kept ones, two-dimensional
  double pixel_scale = 1;   ///< they miss by this many times what the decoder predicted
};

}  // namespace raysteer::calib::solve
