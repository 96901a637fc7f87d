// What both eyes saw of some looks becomes one model of cameras, projector and mirror, which predicts every look.
//
// One problem (docs/mirror-model.md, algorithms 4.9): the cameras with their covariance as prior, projector, mirror and
// command curves with the drawing's tolerances as priors, two latent angles a look with the mirror's repeatability as
// prior. Each surface point belongs to one look alone and is eliminated in closed form: what is left of it are one
// residual between the eyes and two on the panel, whitened (algorithms 3.1).
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/model/steered_projector.hpp"
#include "calib/steer/drawing.hpp"
#include "calib/steer/observations.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::steer {

inline constexpr std::size_t kFewestPoints = 12;  ///< of a look, to count

struct Options {
  /// Accepted up to here. With n >= 1000 residuals a true model and honest noise stay below 1.12 in all but one of 10^6
  /// calibrations (chi-square); noise stated 15 % too small passes, false minima are seen above 3.
  double most_whitened_rms = 1.15;
  double most_repeatability_rad = 500e-6;  ///< what latent angles may explain before the solve is refused
  double most_dropped = 0.3;               ///< share of points that may be left out as outliers
  double off_drawing_sigma = 3.5;          ///< from here on a number is listed in Solution::off_drawing
  double foreign_drawing_sigma = 12;       ///< from here on the solve is refused: kDrawingsDisagree
  int starting_points = 40;                ///< per look, for starts and searches; the last solve uses all
  int starts = 8;                          ///< at most, from the drawing and from numbers near it
  int first_start = 0;                     ///< 0: the drawing; any other: only from numbers near it
  bool open_cameras = false;               ///< known only as drawn: triangulated anew at every step
  bool explain = true;                     ///< when nothing fits, look for the reason: takes longer
};

/// One point of one look after the solve.
struct PointResidual {
  Eigen::Vector3d p;        ///< where both eyes see it, metres, rig frame
  Eigen::Vector2d x;        ///< measured, panel px
  Eigen::Vector2d error;    ///< predicted minus measured, panel px
  double between_eyes = 0;  ///< whitened
  bool used = true;         ///< false: further than 4 sigma off
};

struct SolvedLook {
  std::string name;
  Eigen::Vector2d command_rad;
  Eigen::Vector2d latent_rad;  ///< what the mirror stood off its curve
  double whitened_rms = 0;
  std::vector<PointResidual> points;
};

struct OffDrawing {
  std::string parameter;
  double sigmas = 0;
};

struct Solution {
  model::SteeredProjector projector;
  model::Rig cameras;            ///< with what the looks taught about them; covariance: after the solve
  double repeatability_rad = 0;  ///< one standard deviation per axis; estimated where it departed from the drawing's
  bool repeatability_estimated = false;
  std::vector<SolvedLook> looks;
  double whitened_rms = 0;  ///< of all residuals, per degree of freedom
  double panel_rms_px = 0;  ///< predicted minus measured, latents known: fit, not accuracy
  std::size_t used = 0;
  std::size_t dropped = 0;
  int iterations = 0;
  int starts = 0;  ///< how many were needed
  std::vector<OffDrawing> off_drawing;
  std::vector<std::string> left_out;  ///< looks with fewer than 12 points

  /// Names and joint covariance: the cameras' (order of model::Rig), the projector's
  /// (calib/model/steered_parameters.hpp, names "projector.fx", ...), then "look-1.axis1", "look-1.axis2", ...
  std::vector<std::string> parameters;
  Eigen::MatrixXd covariance;
  int camera_parameters() const;
  int projector_parameters() const;
};

/// Errors. Bad input: kNotFinite, kBadValue, kCameraCount, kTooFewCorrespondences (a look with < 12 points),
/// kTooFewLooks
/// (< 6 looks, or < 4 distinct levels of an axis), kFeedbackDisagrees. Nothing fits, and why: kAxisReversed,
/// kPictureMirrored, kLookForeign, kRigMoved, kDrawingsDisagree; kRigNotSolved where no reason was found.
Result<Solution> solve(const Observations& observations, const Drawing& drawing, const Options& options = {});

}  // namespace raysteer::calib::steer
