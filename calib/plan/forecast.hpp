// value: what looks would tell before they are taken: information, and how far off predictions are at a look.
//
// Everything is linear about the drawing. Matrices are in sigmas of calib/plan/parameters.hpp, so the prior is the unit
// matrix. Cameras count as exactly known: what they do not know is common to all looks and no plan changes it.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <vector>

#include "calib/model/mirror_outline.hpp"
#include "calib/model/rig.hpp"
#include "calib/plan/scene_plane.hpp"
#include "calib/steer/drawing.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::plan {

struct Measuring {
  double noise_px = 0.2;      ///< one standard deviation of each panel and camera coordinate of a point
  int points_per_look = 400;  ///< when the whole panel is seen
  double passing_part = 0.6;  ///< of the picture must get out past the mirrors' outlines
  double border_px = 60;      ///< from the cameras' edges that the picture's middle keeps: drawings are off
};

/// One look.
struct LookForecast {
  Eigen::Vector2d command_rad;
  Eigen::MatrixXd information;   ///< of the parameters, the look's two latent angles marginalised
  Eigen::MatrixXd spread_px;     ///< mean of J^T J over the picture: trace(covariance spread) is the mean squared error
  Eigen::MatrixXd spread_mm;     ///< the same on the plane
  double repeatability_px2 = 0;  ///< mean squared error by the mirror's repeatability alone
  double repeatability_mm2 = 0;
};

class Forecaster {
 public:
  /// Errors: kBadValue (not two cameras, plane without direction or not ahead, tolerances not finite or negative,
  /// noise or points not positive).
  static Result<Forecaster> make(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                                 const Measuring& measuring = {});

  /// Within limits, the picture's middle where both cameras see the plane, and most of the picture past the mirrors.
  bool usable(const Eigen::Vector2d& command_rad) const;
  /// No value when next to nothing of the picture can be measured there.
  std::optional<LookForecast> at(const Eigen::Vector2d& command_rad) const;
  int parameters() const { return static_cast<int>(off_.size()); }
  const steer::Drawing& drawing() const { return drawing_; }

 private:
  struct Sample;
  Forecaster(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
             const Measuring& measuring);
  bool seen_by_both(const Eigen::Vector3d& p, double border_px) const;
  Eigen::Matrix3d triangulated(const Eigen::Vector3d& p) const;
  std::vector<Sample> samples(const Eigen::Vector2d& command_rad) const;

  steer::Drawing drawing_;
  model::Rig cameras_;
  ScenePlane plane_;
  Measuring measuring_;
  std::vector<std::array<model::SteeredProjector, 2>> off_;  ///< each parameter off by a little, either way
};

}  // namespace raysteer::calib::plan
