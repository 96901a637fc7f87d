#include "calib/steer/stages.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/steer/prior.hpp"
#include "hal/base/noise.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr double kGate = 4;        // sigma
constexpr int kAnnealing = 60;     // iterations; rigs that can be solved take 10 to 25
constexpr double kHopeless = 3;    // robust scale after annealing: the middle point is that many sigma off
constexpr double kNoLoss = 1e300;  // a Huber bound that nothing reaches

/// Every n-th point, so that a subset covers what the whole covers.
std::vector<std::size_t> spread(std::size_t count, int wanted) {
  const std::size_t n = wanted > 0 ? std::min(count, static_cast<std::size_t>(wanted)) : count;
  std::vector<std::size_t> picked(n);
  for (std::size_t i = 0; i < n; ++i) {
    picked[i] = i * count / n;
  }
  return picked;
}

}  // namespace

Result<Problem> build(const Observations& observations, const Drawing& drawing, const Eigen::MatrixXd& camera_by_z,
                      const Eigen::VectorXd& z, const Selection& selection) {
  Problem problem{.drawing = drawing,
                  .sigma = prior_sigma(drawing),
                  .z_about = z,
                  .repeatability_rad = drawing.tolerance.repeatability_rad,
                  .looks = {},
                  .split = {},
                  .open = {}};
  const model::Rig cameras = moved_cameras(observations.cameras, camera_by_z * z);
  const Eyes eyes(cameras, camera_by_z);
  for (std::size_t k = 0; k < observations.looks.size(); ++k) {
    if (!selection.left_out.empty() && selection.left_out[k]) {
      continue;
    }
    const Look& look = observations.looks[k];
    ProblemLook built{.command_rad = look.command_rad, .points = {}};
    for (const std::size_t i : spread(look.points.size(), selection.points_per_look)) {
      if (auto eye = eyes.see(look.points[i])) {
        built.points.push_back({.eye = *std::move(eye), .lit = &look.points[i], .index = i});
      }
    }
    if (built.points.size() < kFewestPoints) {
      return fail(RCode::kTooFewCorrespondences, "look '" + look.name + "' has " + std::to_string(built.points.size()) +
                                                     " points that both eyes see; expected at least " +
                                                     std::to_string(kFewestPoints) +
                                                     ": leave the look out, or aim it where both cameras look");
    }
    problem.looks.push_back(std::move(built));
  }
  if (selection.open_cameras) {
    problem.open = {.drawn = observations.cameras, .by_z = camera_by_z};
  }
  return problem;
}

State start_of(const Problem& problem) {
  return {.projector = problem.drawing.projector,
          .z = problem.z_about,
          .latents = std::vector<Eigen::Vector2d>(problem.looks.size(), Eigen::Vector2d::Zero())};
}

State start_near(const Problem& problem, int number) {
  State state = start_of(problem);
  if (number == 0) {
    return state;
  }
  Noise noise(0x57a7, static_cast<std::uint64_t>(number));
  Eigen::VectorXd delta(problem.sigma.size());
  for (Eigen::Index k = 0; k < delta.size(); ++k) {
    delta[k] = problem.sigma[k] * noise.normal();
  }
  delta[1] = delta[0];  // focal lengths go together
  state.projector = model::perturbed(state.projector, delta);
  for (Eigen::Index k = 0; problem.open && k < state.z.size(); ++k) {
    state.z[k] += noise.normal();
  }
  return state;
}

Fit fit_of(const Problem& problem, const State& state) {
  Fit fit;
  double sum = 0;
  double panel = 0;
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const model::SteeredLook look = look_of(problem, state, k);
    std::size_t dropped = 0;
    double look_sum = 0;
    double look_panel = 0;
    for (const ProblemPoint& point : problem.looks[k].points) {
      const auto r = point.used ? residual(problem, state, k, point, look) : std::nullopt;
      dropped += r ? 0 : 1;
      look_sum += r ? r->panel.squaredNorm() + r->between_eyes * r->between_eyes : 0;
      look_panel += r ? r->error_px.squaredNorm() : 0;
    }
    if (2 * dropped > problem.looks[k].points.size()) {
      fit.foreign.push_back(k);
      continue;
    }
    fit.dropped += dropped;
    fit.used += problem.looks[k].points.size() - dropped;
    sum += look_sum;
    panel += look_panel;
  }
  const double degrees = 3.0 * static_cast<double>(fit.used) - unknowns(problem);
  fit.rms = degrees > 0 && std::isfinite(sum) ? std::sqrt(sum / degrees) : std::numeric_limits<double>::infinity();
  fit.panel_rms_px = fit.used > 0 ? std::sqrt(panel / (2.0 * static_cast<double>(fit.used))) : 0;
  return fit;
}

std::size_t drop_outliers(Problem& problem, const State& state, double gate) {
  std::size_t dropped = 0;
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const model::SteeredLook look = look_of(problem, state, k);
    for (ProblemPoint& point : problem.looks[k].points) {
      const auto r = residual(problem, state, k, point, look);
      point.used = r && r->panel.norm() < gate && std::abs(r->between_eyes) < gate;
      dropped += point.used ? 0 : 1;
    }
  }
  return dropped;
}

Eigen::MatrixXd covariance_of(const Problem& problem, const State& state) {
  const Normal normal = normal_equations(problem, state, {.scale = 1, .bound = kNoLoss});
  const Eigen::Index n = normal.h.rows();
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(n);
  unit.segment(problem.z_about.size(), problem.sigma.size()) = problem.sigma;
  unit.segment(problem.z_about.size() + problem.sigma.size(), 2 * static_cast<Eigen::Index>(problem.looks.size()))
      .setConstant(problem.repeatability_rad);
  return unit.asDiagonal() * normal.h.ldlt().solve(Eigen::MatrixXd::Identity(n, n)) * unit.asDiagonal();
}

// MacKay's fixed point: latents have as many degrees of freedom as the data, not their prior, determine.
int settle_repeatability(Problem& problem, State& state, const Options& options) {
  constexpr double kLeast = 1e-6;  // rad: nobody's mirror repeats better, and zero would be held for ever
  int iterations = 0;
  for (int round = 0; round < 8; ++round) {
    const Eigen::MatrixXd covariance = covariance_of(problem, state);
    const double variance = problem.repeatability_rad * problem.repeatability_rad;
    const Eigen::Index first = problem.z_about.size() + problem.sigma.size();
    double squares = 0;
    double degrees = 0;
    for (std::size_t k = 0; k < state.latents.size(); ++k) {
      squares += state.latents[k].squaredNorm();
      for (int axis = 0; axis < 2; ++axis) {
        const Eigen::Index i = first + 2 * static_cast<Eigen::Index>(k) + axis;
        degrees += 1 - std::min(1.0, covariance(i, i) / variance);
      }
    }
    const double ratio = std::sqrt(squares / (std::max(degrees, 0.5) * variance));
    if (ratio > 0.7 && ratio < 1.4) {
      break;
    }
    const double next = std::clamp(problem.repeatability_rad * ratio, kLeast, 4 * options.most_repeatability_rad);
    if (next == problem.repeatability_rad) {
      break;
    }
    problem.repeatability_rad = next;
    iterations += minimise(problem, state, {.huber = kNoLoss});
  }
  return iterations;
}

Attempt attempt(Problem problem, State start, const Options& options, bool cauchy) {
  Attempt result{.state = std::move(start), .fit = {}};
  if (problem.open) {
    see_again(problem, result.state.z);
  }
  result.repeatability_rad = problem.repeatability_rad;
  result.iterations =
      minimise(problem, result.state, {.cauchy = cauchy, .anneal = true, .most_iterations = kAnnealing});
  whiten(problem, result.state);
  if (const double scale = robust_scale(problem, result.state); scale > kHopeless) {
    result.fit.rms = scale;
    return result;
  }
  result.iterations += minimise(problem, result.state, {.cauchy = cauchy});
  drop_outliers(problem, result.state, kGate);
  result.iterations += minimise(problem, result.state, {.huber = kNoLoss});
  result.fit = fit_of(problem, result.state);
  if (result.fit.rms < 2) {
    result.iterations += settle_repeatability(problem, result.state, options);
    whiten(problem, result.state);
    drop_outliers(problem, result.state, kGate);
    result.iterations += minimise(problem, result.state, {.huber = kNoLoss});
    result.fit = fit_of(problem, result.state);
  }
  const double all = static_cast<double>(result.fit.used + result.fit.dropped);
  result.repeatability_rad = problem.repeatability_rad;
  // A subset has fewer residuals than the whole: a little more is allowed.
  result.fits = result.fit.rms < options.most_whitened_rms + 0.1 &&
                static_cast<double>(result.fit.dropped) < options.most_dropped * all &&
                5 * result.fit.foreign.size() <= 2 * problem.looks.size() &&
                problem.repeatability_rad <= options.most_repeatability_rad;
  result.off_drawing = prior_residuals(problem.drawing, problem.sigma, result.state.projector).cwiseAbs().maxCoeff();
  if (result.off_drawing > options.foreign_drawing_sigma) {
    result.fits = false;
  }
  return result;
}

Attempt attempts(const Problem& problem, const Options& options, int starts, int* used) {
  Attempt best;
  int iterations = 0;
  const auto grade = [](const Attempt& a) { return a.fits_all() ? 2 : a.fits ? 1 : 0; };
  for (int number = options.first_start; number < options.first_start + starts; ++number) {
    Attempt next = attempt(problem, start_near(problem, number), options);
    iterations += next.iterations;
    if (number == options.first_start || grade(next) > grade(best) ||
        (grade(next) == grade(best) && next.fit.rms < best.fit.rms)) {
      best = std::move(next);
    }
    if (used != nullptr) {
      *used = number + 1 - options.first_start;
    }
    // Foreign looks are believed when four starts agree that there is nothing better.
    if (best.fits_all() || (best.fits && number >= options.first_start + 3)) {
      break;
    }
  }
  best.iterations = iterations;
  return best;
}

}  // namespace raysteer::calib::steer
