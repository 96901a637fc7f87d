// From what was seen of a target to a solved rig: one camera, several, or cameras and a projector.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "calib/solve/state.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::solve {

struct SolveOptions {
  /// Of the cameras; none: the simplest that held-out corners do not speak against. Projectors are always BC4.
  std::optional<model::LensModel> lens;
  /// First guess of the projector's focal length, px; 0: a linear solution, which needs none. The answer must not
  /// depend on it.
  double projector_start_px = 0;
  /// Told what is being done and how far it is, 0 to 1.
  std::function<void(std::string_view stage, double done)> progress;
};

/// Fewest views a solve accepts.
constexpr int kFewestViews = 4;

/// Solves all devices together. Views that disagree with the others are left out and named in the solution.
///
/// Errors: kTargetScaleMissing, kCameraCount, kNotFinite, kTooFewViews, kCoplanarViews, kMirroredTarget (a device that
/// flips its image), kForeignView (too many views disagree), kCameraMovedDuringCapture (names the view after which the
/// devices stand otherwise), kTooFewCorrespondences, kSolverDiverged.
Result<Solution> solve(const Observations& observations, const SolveOptions& options = {});

/// The unknowns of a solution, and the measurements it kept of the views chosen (empty: all used ones): what is needed
/// to solve again without some views.
State state_of(const Solution& solution);
Measurements kept_measurements(const Observations& observations, const Solution& solution,
                               const std::vector<bool>& views = {});

}  // namespace raysteer::calib::solve
