// The steps of one attempt at a rig: a subset of points, a start, a verdict.
#pragma once

#include <optional>
#include <vector>

#include "calib/steer/minimise.hpp"
#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {

/// Which of the looks and points a problem is built from.
struct Selection {
  int points_per_look = 0;       ///< 0: all
  std::vector<bool> left_out{};  ///< per look; empty: none
  bool open_cameras = false;     ///< Problem::open
};

/// The problem with its points triangulated by the cameras moved to `z`. Looks keep their order; left-out ones are
/// dropped. Errors: kTooFewCorrespondences (a look with fewer than 12 points that both eyes see).
Result<Problem> build(const Observations& observations, const Drawing& drawing, const Eigen::MatrixXd& camera_by_z,
                      const Eigen::VectorXd& z, const Selection& selection = {});

/// The drawing, with nothing learnt.
State start_of(const Problem& problem);

/// The drawing with numbers near it, by one tolerance each, those of open cameras too; the same for the same `number`.
State start_near(const Problem& problem, int number);

/// How well a state explains a problem.
struct Fit {
  double rms = 0;  ///< whitened, per degree of freedom, used points
  double panel_rms_px = 0;
  std::size_t used = 0;
  std::size_t dropped = 0;             ///< outliers of the looks that fit
  std::vector<std::size_t> foreign{};  ///< looks most of whose points are outliers
};
Fit fit_of(const Problem& problem, const State& state);

/// Marks points beyond `gate` as unused; returns how many.
std::size_t drop_outliers(Problem& problem, const State& state, double gate);

/// Covariance of the unknowns in their own units (not the prior's).
Eigen::MatrixXd covariance_of(const Problem& problem, const State& state);

/// One attempt: annealed from `state`, then robust; outliers dropped, then without loss.
/// Re-estimates the repeatability where the latents depart from it by more than 0.7 to 1.4.
struct Attempt {
  State state{};
  Fit fit{};
  double repeatability_rad = 0;
  double off_drawing = 0;  ///< of the number farthest from the drawing, tolerances
  int iterations = 0;
  bool fits = false;  ///< all looks but few foreign ones
  bool fits_all() const { return fits && fit.foreign.empty(); }
};
/// `cauchy`: looks may be sacrificed; otherwise all pull (Huber).
Attempt attempt(Problem problem, State start, const Options& options, bool cauchy = true);

/// The same from several starts until one fits; the best one if none does.
Attempt attempts(const Problem& problem, const Options& options, int starts, int* used = nullptr);

/// Re-estimates the mirror's repeatability in `problem` and minimises again until both agree.
int settle_repeatability(Problem& problem, State& state, const Options& options);

}  // namespace raysteer::calib::steer
