// The bundle adjustment: one least-squares problem over all devices and views. The only place that knows Ceres.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

/// What is estimated, and how.
struct AdjustOptions {
  bool robust = false;  ///< Cauchy loss of 2 sigma; else plain least squares
  /// Per device; empty: all free.
  std::vector<bool> free_intrinsics{};
  std::vector<bool> free_distortion{};  ///< false: focal lengths and principal point only
  std::vector<bool> free_focal{};
  std::vector<bool> free_pose{};
  bool free_views = true;
  bool free_sag = true;
  int max_iterations = 60;
};

struct AdjustReport {
  double cost = 0;  ///< half the sum of squared whitened residuals (after the loss)
  int iterations = 0;
};

/// Moves `state` to the minimum. Errors: kSolverDiverged, kNotFinite; the state is then as it was.
Result<AdjustReport> adjust(const Measurements& measurements, const AdjustOptions& options, State& state);

/// Covariance of what all views share, from our own Jacobian: (A - B D^-1 B^T)^-1 with the views' poses eliminated.
struct Covariance {
  /// Order of model::Rig: device by device, then the two sags. Fixed parameters have zero rows and columns.
  Eigen::MatrixXd shared;
};
Result<Covariance> covariance(const Measurements& measurements, const State& state);

/// px per coordinate below which no error is believed to be (algorithms 1.3).
constexpr double kSigmaFloor = 0.05;
/// What a decoded pixel is weighted by, px per coordinate.
double pixel_sigma(const Measurements& measurements, const PixelMeasurement& pixel);

// Weak knowledge that keeps what views leave open in bounds.
/// Sag of a printed board: 0.3 mm over 0.8 m is common (algorithms 1.3); ten times that is a bent one.
double sag_sigma(const TargetSpec& target);
/// fx / fy of a projector: square pixels to 0.2 % (algorithms 3.1).
constexpr double kProjectorAspectSigma = 0.002;

}  // namespace raysteer::calib::solve
