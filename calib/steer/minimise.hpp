// Levenberg-Marquardt with the scale of the residuals brought down step by step.
#pragma once

#include "calib/steer/problem.hpp"

namespace raysteer::calib::steer {

struct Minimise {
  double huber = 3;
  bool cauchy = false;  ///< instead of Huber
  /// Start with residuals divided by their robust scale: far from the solution the drawing's tolerances then still
  /// hold what the data cannot yet tell, and steps stay within what a workshop delivers.
  bool anneal = false;
  int most_iterations = 60;
};

/// Improves `state` in place; returns the iterations. Whitening is refreshed while annealing.
int minimise(Problem& problem, State& state, const Minimise& how);

}  // namespace raysteer::calib::steer
