#include "calib/steer/minimise.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace raysteer::calib::steer {

int minimise(Problem& problem, State& state, const Minimise& how) {
  Weighting weighting{.scale = 1, .bound = how.huber, .cauchy = how.cauchy};
  if (how.anneal) {
    whiten(problem, state);
    weighting.scale = std::max(1.0, robust_scale(problem, state));
  }
  double damping = 1e-6;
  int quiet = 0;
  int iteration = 0;
  for (; iteration < how.most_iterations && quiet < 2; ++iteration) {
    const Normal normal = normal_equations(problem, state, weighting);
    bool better = false;
    double gain = 0;
    for (int attempt = 0; attempt < 12 && !better; ++attempt) {
      Eigen::MatrixXd damped = normal.h;
      damped.diagonal() *= 1 + damping;
      const Eigen::VectorXd step = -damped.ldlt().solve(normal.g);
      if (step.allFinite()) {
        State next = moved(problem, state, step);
        std::optional<Problem> there;  // where open cameras would see everything after the step
        if (problem.open) {
          there = problem;
          see_again(*there, next.z);
        }
        const double next_cost = cost(there ? *there : problem, next, weighting);
        if (next_cost < normal.cost) {
          if (there) {
            problem = *std::move(there);
          }
          better = true;
          gain = (normal.cost - next_cost) / normal.cost;
          state = std::move(next);
          damping = std::max(damping / 10, 1e-9);
          continue;
        }
        if (next_cost - normal.cost < 1e-9 * normal.cost) {
          break;  // nothing left but rounding
        }
      }
      damping = std::max(damping * 10, 1e-6);
    }
    if (weighting.scale > 1 && how.anneal) {
      whiten(problem, state);
      const double before = weighting.scale;
      weighting.scale = std::max(1.0, std::min(before, robust_scale(problem, state)));
      quiet = better && (gain > 1e-5 || weighting.scale < 0.999 * before) ? 0 : quiet + 1;
    } else {
      quiet = better && gain > 1e-8 ? 0 : quiet + 1;
    }
  }
  return iteration;
}

}  // namespace raysteer::calib::steer
