// How far off a solved rig is at looks it never saw.
#pragma once

#include <span>
#include <vector>

#include "calib/steer/predict.hpp"
#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {

/// One point of a held-out look: predicted minus measured, the noise averaged out.
struct HeldOutPoint {
  Eigen::Vector3d p;      ///< metres, rig frame
  Eigen::Vector3d off_m;  ///< across the light
};

struct HeldOutLook {
  std::string name;
  double median_px = 0;
  double p95_px = 0;
  std::vector<HeldOutPoint> points;
};

/// Errors are predicted minus measured panel pixel of a measured surface point, open loop: latent angles are unknown
/// there. `smooth` is the error's trend over the panel, a quadratic fitted by weight to each look's points: what is
/// left once the measurement's own noise, which is as large, is averaged out. Judge by it; the raw numbers bound it.
struct Evaluation {
  double median_px = 0, p95_px = 0;
  double median_mm = 0, p95_mm = 0;  ///< on the surface, across the light
  double raw_median_px = 0, raw_p95_px = 0;
  double raw_median_mm = 0, raw_p95_mm = 0;
  double predicted_rms_px = 0;  ///< what the solution's covariance leads one to expect of `smooth`
  double normalised = 0;  ///< mean squared smooth error over its predicted variance, per coordinate: 1 when honest
  double within_95 = 0;   ///< share of smooth errors inside the ellipse that the covariance states for 95 %
  std::size_t points = 0;
  std::vector<HeldOutLook> looks;
  std::vector<double> px, mm;  ///< every smooth error, to pool over rigs
};

/// `states`: what is known of the mirror at each look, as after refine_look() by points that are not among the look's;
/// empty: nothing. Errors: kTooFewLooks (none), kTooFewCorrespondences, kNotFinite.
Result<Evaluation> evaluate(const Solution& solution, std::span<const Look> looks,
                            std::span<const LookState> states = {});

}  // namespace raysteer::calib::steer
