// A few dots close the loop: the mirror's two angles at a look, and its drift since the calibration.
#pragma once

#include <span>
#include <vector>

#include "calib/steer/predict.hpp"

namespace raysteer::calib::steer {

/// A dot of the panel and where it was seen.
struct Dot {
  Eigen::Vector2d x;           ///< panel px
  Eigen::Vector3d p;           ///< metres, rig frame
  Eigen::Matrix3d covariance;  ///< m^2
};

struct RefinedLook {
  LookState state;          ///< pass it to predict()
  double whitened_rms = 0;  ///< of the dots that were used
  std::size_t used = 0;
};

/// Two angles from at least 4 dots (algorithms 4.10). `prior_rad`: how far off the angles may be; default generous.
/// Errors: kTooFewCorrespondences, kNotFinite, kLookNotSolved (dots contradict each other).
Result<RefinedLook> refine_look(const Solution& solution, const Eigen::Vector2d& command_rad, std::span<const Dot> dots,
                                double prior_rad = 5e-3);

/// What axis k turned off since the calibration: offset[k] + gain[k] * angle, radians.
struct Drift {
  Eigen::Vector2d offset_rad = Eigen::Vector2d::Zero();
  Eigen::Vector2d gain = Eigen::Vector2d::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  ///< offset 1, 2, gain 1, 2
  double whitened_rms = 0;

  /// The latent angles to expect at a command, and their covariance with the mirror's repeatability.
  LookState at(const Solution& solution, const Eigen::Vector2d& command_rad) const;
};

struct DriftPrior {
  double offset_rad = 500e-6;
  double gain = 1e-3;
};

struct DottedLook {
  Eigen::Vector2d command_rad;
  std::vector<Dot> dots;
};

/// Offset and gain of both axes from dots at several looks (a gain is told from an offset by looks apart; a single look
/// leaves it to the prior). Errors as refine_look().
Result<Drift> refine_drift(const Solution& solution, std::span<const DottedLook> looks, const DriftPrior& prior = {});

}  // namespace raysteer::calib::steer
