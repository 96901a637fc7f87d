// pure: the plan of looks for a drawing and a scene, with what it will be worth before a single shot.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "calib/plan/forecast.hpp"

namespace raysteer::calib::plan {

struct LookOptions {
  int looks = 16;
  int held_out = 8;     ///< besides these, never solved from: the test
  int candidates = 13;  ///< per axis, over the usable commands
  Measuring measuring;
};

constexpr int kFewestLooks = 6;  ///< fewer leave errors of many pixels whatever is planned (algorithms 4.8)

/// Root mean square errors that are to be expected at a look nobody has taken, over the usable commands.
struct Prediction {
  double model_px = 0;  ///< by what the solved model does not know; what a closed loop at the look leaves is below this
  double model_mm = 0;
  double unseen_px = 0;  ///< with the mirror's repeatability, which no plan removes
  double unseen_mm = 0;
};

struct PlannedLook {
  Eigen::Vector2d command_rad;
  bool held_out = false;
};

struct LookPlan {
  std::vector<PlannedLook> looks;  ///< in the order to visit them, held-out ones among the others
  Prediction prediction;
  bool regular = false;       ///< a 4 x 4 grid: too few commands are usable to choose from
  int from_above = 0;         ///< looks approached from above on an axis; a mirror with backlash overshoots there first
  int usable = 0;             ///< candidates
  Eigen::Vector2d least_rad;  ///< box round the usable commands
  Eigen::Vector2d most_rad;
};

/// I-optimal: errors of predictions, averaged over the usable commands, become as small as the number of looks allows.
/// The same input gives the same plan. Errors: those of Forecaster::make(); kTooFewLooks (fewer than six asked for, or
/// usable: then what stands in the way); kBadValue (counts that are negative or beyond the candidates).
Result<LookPlan> plan_looks(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                            const LookOptions& options = {});

/// What the looks of anybody's plan would be worth. Those of which nothing could be measured do not count. Errors: as
/// above.
Result<Prediction> predict(const steer::Drawing& drawing, const model::Rig& cameras, const ScenePlane& plane,
                           std::span<const Eigen::Vector2d> commands_rad, const LookOptions& options = {});

}  // namespace raysteer::calib::plan
