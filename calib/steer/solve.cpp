#include "calib/steer/solve.hpp"

#include <algorithm>
#include <cmath>

#include "calib/model/steered_parameters.hpp"
#include "calib/steer/check.hpp"
#include "calib/steer/explain.hpp"
#include "calib/steer/prior.hpp"
#include "calib/steer/stages.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr int kRelinear = 8;
constexpr double kScattered = 2.5;  // times the stated repeatability: no mirror of that make

std::string sayable(double value) {
  const std::string text = std::to_string(value);
  return text.substr(0, text.find('.') + 3);
}

std::vector<std::string> names_of(const Observations& observations, const Drawing& drawing) {
  std::vector<std::string> names = observations.cameras.parameters;
  for (std::size_t i = 0; names.size() < static_cast<std::size_t>(observations.cameras.covariance.rows()); ++i) {
    names.push_back("cameras." + std::to_string(i));
  }
  for (const std::string& name : model::steered_parameter_names(drawing.projector.kind)) {
    names.push_back("projector." + name);
  }
  for (const Look& look : observations.looks) {
    names.push_back(look.name + ".axis1");
    names.push_back(look.name + ".axis2");
  }
  return names;
}

SolvedLook solved_look(const Look& look, const Problem& problem, const State& state, std::size_t k) {
  SolvedLook solved{.name = look.name, .command_rad = look.command_rad, .latent_rad = state.latents[k], .points = {}};
  const model::SteeredLook steered = look_of(problem, state, k);
  double sum = 0;
  std::size_t count = 0;
  for (const ProblemPoint& point : problem.looks[k].points) {
    const auto r = residual(problem, state, k, point, steered);
    if (!r) {
      continue;
    }
    solved.points.push_back({r->p, point.eye.x, r->error_px, r->between_eyes, point.used});
    if (point.used) {
      sum += r->panel.squaredNorm() + r->between_eyes * r->between_eyes;
      count += 3;
    }
  }
  solved.whitened_rms = count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0;
  return solved;
}

std::vector<OffDrawing> off_drawing(const Problem& problem, const State& state, double from) {
  std::vector<OffDrawing> off;
  const std::vector<std::string> names = model::steered_parameter_names(state.projector.kind);
  const Eigen::VectorXd sigmas = prior_residuals(problem.drawing, problem.sigma, state.projector);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (const double s = sigmas[static_cast<Eigen::Index>(k)]; std::abs(s) > from) {
      off.push_back({k == 0 ? "focal length" : k == 1 ? "aspect" : names[k], s});
    }
  }
  std::ranges::sort(off,
                    [](const OffDrawing& a, const OffDrawing& b) { return std::abs(a.sigmas) > std::abs(b.sigmas); });
  return off;
}

}  // namespace

int Solution::camera_parameters() const { return static_cast<int>(cameras.covariance.rows()); }
int Solution::projector_parameters() const { return model::steered_parameters(projector.kind); }

Result<Solution> solve(const Observations& given, const Drawing& drawing, const Options& options) {
  Observations observations{.cameras = given.cameras, .looks = {}};
  Solution solution;
  for (const Look& look : given.looks) {
    if (look.points.size() < kFewestPoints) {
      solution.left_out.push_back(look.name);
    } else {
      observations.looks.push_back(look);
    }
  }
  RAYSTEER_TRY(check(observations, drawing));
  const Eigen::MatrixXd by_z = camera_prior(observations.cameras);
  const Eigen::VectorXd as_calibrated = Eigen::VectorXd::Zero(by_z.cols());

  // A start from few points, by as many tries as it takes.
  auto few = build(observations, drawing, by_z, as_calibrated,
                   {.points_per_look = options.starting_points, .open_cameras = options.open_cameras});
  RAYSTEER_TRY(few);
  Attempt start = attempts(*few, options, options.starts, &solution.starts);
  if (!start.fits_all()) {
    return why_not(observations, drawing, options, start);
  }
  solution.iterations = start.iterations;

  // All points, about the cameras as they came out; whitened and triangulated again once.
  State state = start.state;
  Problem problem;
  double moved_z = 0;
  for (int round = 0; round < 2 || (round < kRelinear && moved_z > 1); ++round) {
    auto all = build(observations, drawing, by_z, state.z, {.open_cameras = options.open_cameras});
    RAYSTEER_TRY(all);
    const double repeatability = round == 0 ? start.repeatability_rad : problem.repeatability_rad;
    problem = *std::move(all);
    problem.repeatability_rad = repeatability;
    whiten(problem, state);
    if (round == 0 || moved_z > 1) {
      solution.iterations += minimise(problem, state, {.cauchy = true});
      whiten(problem, state);
    }
    drop_outliers(problem, state, 4);
    solution.iterations += minimise(problem, state, {.huber = 1e300});
    solution.iterations += settle_repeatability(problem, state, options);
    moved_z = (state.z - problem.z_about).norm();
  }
  const Fit fit = fit_of(problem, state);
  const bool agreed = fit.foreign.empty() && static_cast<double>(fit.dropped) <
                                                 options.most_dropped * static_cast<double>(fit.used + fit.dropped);
  if (!agreed || !(fit.rms <= options.most_whitened_rms) ||
      problem.repeatability_rad > options.most_repeatability_rad) {
    return why_not(observations, drawing, options,
                   {.state = state, .fit = fit, .repeatability_rad = problem.repeatability_rad});
  }
  if (options.explain && problem.repeatability_rad > kScattered * drawing.tolerance.repeatability_rad) {
    if (auto reason = why_scattered(observations, drawing, options, problem.repeatability_rad)) {
      return *std::move(reason);
    }
  }

  solution.projector = state.projector;
  solution.whitened_rms = fit.rms;
  solution.panel_rms_px = fit.panel_rms_px;
  solution.used = fit.used;
  solution.dropped = fit.dropped;
  solution.repeatability_rad = problem.repeatability_rad;
  solution.repeatability_estimated = problem.repeatability_rad != drawing.tolerance.repeatability_rad;
  for (std::size_t k = 0; k < observations.looks.size(); ++k) {
    solution.looks.push_back(solved_look(observations.looks[k], problem, state, k));
  }
  solution.off_drawing = off_drawing(problem, state, options.off_drawing_sigma);
  if (!solution.off_drawing.empty() && std::abs(solution.off_drawing.front().sigmas) > options.foreign_drawing_sigma) {
    const OffDrawing& worst = solution.off_drawing.front();
    return fail(RCode::kDrawingsDisagree, "'" + worst.parameter + "' came out " + sayable(std::abs(worst.sigmas)) +
                                              " tolerances away from the board file; expected at most " +
                                              sayable(options.foreign_drawing_sigma));
  }

  // Noise that was stated too small makes the answer as much less sure; stated too large, not surer.
  const Eigen::MatrixXd covariance = std::max(1.0, fit.rms * fit.rms) * covariance_of(problem, state);
  const Eigen::Index n_z = by_z.cols();
  const Eigen::Index n_c = by_z.rows();
  const Eigen::Index rest = covariance.rows() - n_z;
  Eigen::MatrixXd to_parameters = Eigen::MatrixXd::Zero(n_c + rest, n_z + rest);
  to_parameters.topLeftCorner(n_c, n_z) = by_z;
  to_parameters.bottomRightCorner(rest, rest).setIdentity();
  solution.covariance = to_parameters * covariance * to_parameters.transpose();
  solution.parameters = names_of(observations, drawing);
  solution.cameras = moved_cameras(observations.cameras, by_z * state.z);
  solution.cameras.covariance = solution.covariance.topLeftCorner(n_c, n_c);
  return solution;
}

}  // namespace raysteer::calib::steer
