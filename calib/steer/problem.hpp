// value: the one least-squares problem behind a steered rig, its cost and its normal equations.
//
// Unknowns, all in units of their priors: cameras z, projector, two latent angles a look, and, where the rig is
// supposed to have moved before look `split`, twelve more: what the projector (6) and the right camera (6) moved by.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calib/model/steered_look.hpp"
#include "calib/steer/drawing.hpp"
#include "calib/steer/eye_points.hpp"

namespace raysteer::calib::steer {

struct State {
  model::SteeredProjector projector;
  Eigen::VectorXd z;                     ///< of the cameras (eye_points.hpp)
  std::vector<Eigen::Vector2d> latents;  ///< rad
  /// After the split: of the projector (6) and the right camera (6), left increments.
  Eigen::Matrix<double, 12, 1> moved = Eigen::Matrix<double, 12, 1>::Zero();
};

struct ProblemPoint {
  EyePoint eye;
  const LitPoint* lit = nullptr;                         ///< what it was triangulated from; outlives the problem
  std::size_t index = 0;                                 ///< in its look
  Eigen::Matrix2d whiten = Eigen::Matrix2d::Identity();  ///< of the panel residual (algorithms 3.1)
  bool used = true;
};

struct ProblemLook {
  Eigen::Vector2d command_rad;
  std::vector<ProblemPoint> points;
};

/// Cameras known only as drawn: by_z is far from linear over their tolerances.
struct OpenCameras {
  model::Rig drawn;
  Eigen::MatrixXd by_z;
};

struct Problem {
  Drawing drawing;
  Eigen::VectorXd sigma;    ///< of the projector's parameters
  Eigen::VectorXd z_about;  ///< where the points are linear about
  double repeatability_rad = 20e-6;
  std::vector<ProblemLook> looks;
  std::optional<std::size_t> split;
  std::optional<OpenCameras> open;  ///< points are then triangulated anew wherever a step takes the cameras
};

/// Triangulates all points by open cameras at z, where the problem is linear about from then on. A point whose rays no
/// longer meet stays where it was and costs much.
void see_again(Problem& problem, const Eigen::VectorXd& z);

/// How residuals are counted: |whitened| / scale beyond `bound` counts linearly (Huber), or by its logarithm (Cauchy):
/// then a whole look that is another's hardly pulls.
struct Weighting {
  double scale = 1;
  double bound = 3;
  bool cauchy = false;
};

struct Normal {
  double cost = 0;  ///< prior and residuals
  Eigen::MatrixXd h;
  Eigen::VectorXd g;  ///< gradient / 2
};

int unknowns(const Problem& problem);

/// `state` moved by a step in prior units.
State moved(const Problem& problem, const State& state, const Eigen::VectorXd& step);

double cost(const Problem& problem, const State& state, const Weighting& weighting);
Normal normal_equations(const Problem& problem, const State& state, const Weighting& weighting);

/// Standard deviations of State::moved: a bump is taken to be as large as a mount's tolerance.
Eigen::Matrix<double, 12, 1> moved_sigma(const Problem& problem);

/// Whitened panel residual and residual between the eyes of one point of look k. No value where the light's way ends
/// behind the lens.
struct Residual {
  Eigen::Vector2d panel;
  double between_eyes = 0;
  Eigen::Vector3d p;
  Eigen::Vector2d error_px;
};
std::optional<Residual> residual(const Problem& problem, const State& state, std::size_t k, const ProblemPoint& point,
                                 const model::SteeredLook& look);

/// The look as the state has it.
model::SteeredLook look_of(const Problem& problem, const State& state, std::size_t k);

/// Whitens the panel residuals with the slopes at `state`.
void whiten(Problem& problem, const State& state);

/// Root of the median squared whitened panel residual, scaled so that honest noise gives 1.
double robust_scale(const Problem& problem, const State& state);

}  // namespace raysteer::calib::steer
