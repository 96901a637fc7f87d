#include "calib/steer/problem.hpp"

#include <algorithm>
#include <cmath>

#include "calib/steer/prior.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr int kMoved = 12;
constexpr double kBehind = 1e4;  // whitened: a point whose light would have to come from behind the lens

struct Offsets {
  int z, projector, latents, moved, all;

  explicit Offsets(const Problem& problem)
      : z(0),
        projector(static_cast<int>(problem.z_about.size())),
        latents(projector + static_cast<int>(problem.sigma.size())),
        moved(latents + 2 * static_cast<int>(problem.looks.size())),
        all(moved + (problem.split ? kMoved : 0)) {}
};

/// Cost and weight of a squared residual.
struct Counted {
  double cost, weight;

  Counted(double squared, const Weighting& weighting) {
    const double e2 = squared / (weighting.scale * weighting.scale);
    const double k = weighting.bound;
    if (weighting.cauchy) {
      cost = k * k * std::log1p(e2 / (k * k));
      weight = 1 / (1 + e2 / (k * k));
      return;
    }
    const double e = std::sqrt(e2);
    cost = e <= k ? e2 : 2 * k * e - k * k;
    weight = e <= k ? 1 : k / e;
  }
};

bool after_split(const Problem& problem, std::size_t k) { return problem.split && k >= *problem.split; }

double prior_cost(const Problem& problem, const State& state) {
  double sum = state.z.squaredNorm() + prior_residuals(problem.drawing, problem.sigma, state.projector).squaredNorm();
  for (const Eigen::Vector2d& latent : state.latents) {
    sum += latent.squaredNorm() / (problem.repeatability_rad * problem.repeatability_rad);
  }
  if (problem.split) {
    sum += state.moved.cwiseQuotient(moved_sigma(problem)).squaredNorm();
  }
  return sum;
}

/// Rows of one look, in the order z, projector, latents (2), moved (6).
struct LookRows {
  Eigen::MatrixXd rows;
  Eigen::VectorXd residuals;
  Eigen::Index count = 0;
  double cost = 0;
};

LookRows rows_of(const Problem& problem, const State& state, const Weighting& weighting, std::size_t k) {
  const Offsets at(problem);
  const ProblemLook& look = problem.looks[k];
  const model::SteeredLook steered = look_of(problem, state, k);
  const int n_z = at.projector;
  const int n_p = at.latents - at.projector;
  LookRows out;
  const auto most = static_cast<Eigen::Index>(3 * look.points.size());
  const int width = n_z + n_p + 2 + (problem.split ? kMoved : 0);
  // Row-major would be natural, column-major multiplies faster; rows are few thousand, so either fits the cache.
  out.rows.setZero(most, width);
  out.residuals.setZero(most);
  const Eigen::VectorXd dz = state.z - problem.z_about;
  const Eigen::Matrix<double, 6, 1> bump_sigma = moved_sigma(problem).tail<6>();
  for (const ProblemPoint& point : look.points) {
    if (!point.used) {
      continue;
    }
    const bool after = after_split(problem, k);
    double between = point.eye.between_eyes + point.eye.between_by_z * dz;
    Eigen::Vector3d p = point.eye.p + point.eye.p_by_z * dz;
    if (after) {
      between += point.eye.between_by_right * state.moved.tail<6>();
      p += point.eye.p_by_right * state.moved.tail<6>();
    }
    const Counted eyes(between * between, weighting);
    out.cost += eyes.cost;
    const double eyes_weight = std::sqrt(eyes.weight) / weighting.scale;
    out.residuals[out.count] = eyes_weight * between;
    out.rows.row(out.count).head(n_z) = eyes_weight * point.eye.between_by_z;
    if (after) {
      out.rows.row(out.count).tail<6>() = eyes_weight * point.eye.between_by_right * bump_sigma.asDiagonal();
    }
    ++out.count;
    model::PixelDerivatives by;
    const auto x = steered.project(p, by);
    if (!x) {
      out.cost += Counted(kBehind * kBehind, weighting).cost;
      continue;
    }
    const Eigen::Vector2d e = point.whiten * (*x - point.eye.x);
    const Counted panel(e.squaredNorm(), weighting);
    out.cost += panel.cost;
    const Eigen::Matrix2d w = std::sqrt(panel.weight) / weighting.scale * point.whiten;
    out.residuals.segment<2>(out.count) = std::sqrt(panel.weight) / weighting.scale * e;
    auto rows = out.rows.middleRows<2>(out.count);
    const Eigen::Matrix<double, 2, 3> by_point = w * by.by_point;
    rows.leftCols(n_z) = by_point * point.eye.p_by_z;
    rows.middleCols(n_z, n_p) = w * by.by_parameters * problem.sigma.asDiagonal();
    rows.middleCols<2>(n_z + n_p) = w * by.by_angles * problem.repeatability_rad;
    if (after) {
      rows.rightCols<12>().leftCols<6>() =
          w * by.by_parameters.middleCols<6>(model::kLensParameters) * bump_sigma.asDiagonal();
      rows.rightCols<6>() = by_point * point.eye.p_by_right * bump_sigma.asDiagonal();
    }
    out.count += 2;
  }
  return out;
}

}  // namespace

Eigen::Matrix<double, 12, 1> moved_sigma(const Problem& problem) {
  Eigen::Matrix<double, 6, 1> sigma;
  sigma << Eigen::Vector3d::Constant(problem.drawing.tolerance.mount_rad),
      Eigen::Vector3d::Constant(problem.drawing.tolerance.mount_m);
  return sigma.replicate<2, 1>();
}

void see_again(Problem& problem, const Eigen::VectorXd& z) {
  const model::Rig cameras = moved_cameras(problem.open->drawn, problem.open->by_z * z);
  const Eyes eyes(cameras, problem.open->by_z);
  for (ProblemLook& look : problem.looks) {
    for (ProblemPoint& point : look.points) {
      if (auto eye = eyes.see(*point.lit)) {
        point.eye = *std::move(eye);
      } else {
        point.eye.between_eyes = kBehind;
        point.eye.between_by_z.setZero();
        point.eye.p_by_z.setZero();
      }
    }
  }
  problem.z_about = z;
}

int unknowns(const Problem& problem) { return Offsets(problem).all; }

model::SteeredLook look_of(const Problem& problem, const State& state, std::size_t k) {
  if (after_split(problem, k)) {
    model::SteeredProjector projector = state.projector;
    projector.T_projector_rig = model::moved_by(projector.T_projector_rig, state.moved.head<6>());
    return {projector, problem.looks[k].command_rad, state.latents[k]};
  }
  return {state.projector, problem.looks[k].command_rad, state.latents[k]};
}

State moved(const Problem& problem, const State& state, const Eigen::VectorXd& step) {
  const Offsets at(problem);
  State next = state;
  next.z += step.head(at.projector);
  next.projector = model::perturbed(state.projector,
                                    problem.sigma.cwiseProduct(step.segment(at.projector, at.latents - at.projector)));
  for (std::size_t k = 0; k < next.latents.size(); ++k) {
    next.latents[k] += problem.repeatability_rad * step.segment<2>(at.latents + 2 * static_cast<int>(k));
  }
  if (problem.split) {
    next.moved += moved_sigma(problem).cwiseProduct(step.tail<kMoved>());
  }
  return next;
}

std::optional<Residual> residual(const Problem& problem, const State& state, std::size_t k, const ProblemPoint& point,
                                 const model::SteeredLook& look) {
  const Eigen::VectorXd dz = state.z - problem.z_about;
  Residual r{.panel = {}, .p = point.eye.p + point.eye.p_by_z * dz, .error_px = {}};
  r.between_eyes = point.eye.between_eyes + point.eye.between_by_z * dz;
  if (after_split(problem, k)) {
    r.p += point.eye.p_by_right * state.moved.tail<6>();
    r.between_eyes += point.eye.between_by_right * state.moved.tail<6>();
  }
  const auto x = look.project(r.p);
  if (!x) {
    return std::nullopt;
  }
  r.error_px = *x - point.eye.x;
  r.panel = point.whiten * r.error_px;
  return r;
}

double cost(const Problem& problem, const State& state, const Weighting& weighting) {
  double sum = prior_cost(problem, state);
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const model::SteeredLook look = look_of(problem, state, k);
    for (const ProblemPoint& point : problem.looks[k].points) {
      if (!point.used) {
        continue;
      }
      const auto r = residual(problem, state, k, point, look);
      sum += r ? Counted(r->panel.squaredNorm(), weighting).cost +
                     Counted(r->between_eyes * r->between_eyes, weighting).cost
               : Counted(kBehind * kBehind, weighting).cost;
    }
  }
  return sum;
}

Normal normal_equations(const Problem& problem, const State& state, const Weighting& weighting) {
  const Offsets at(problem);
  Normal normal{.cost = prior_cost(problem, state), .h = Eigen::MatrixXd::Zero(at.all, at.all), .g = {}};
  normal.g = Eigen::VectorXd::Zero(at.all);
  const int n = at.latents;  // z and projector
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const LookRows look = rows_of(problem, state, weighting, k);
    normal.cost += look.cost;
    const auto rows = look.rows.topRows(look.count);
    const Eigen::MatrixXd h = rows.transpose() * rows;
    const Eigen::VectorXd g = rows.transpose() * look.residuals.head(look.count);
    // Blocks of the look's own columns, and where they go.
    std::vector<std::array<int, 3>> blocks{{0, 0, n}, {n, at.latents + 2 * static_cast<int>(k), 2}};
    if (problem.split) {
      blocks.push_back({n + 2, at.moved, kMoved});
    }
    for (const auto& [from, to, count] : blocks) {
      normal.g.segment(to, count) += g.segment(from, count);
      for (const auto& [from2, to2, count2] : blocks) {
        normal.h.block(to, to2, count, count2) += h.block(from, from2, count, count2);
      }
    }
  }
  Eigen::MatrixXd by_move;
  const Eigen::VectorXd prior = prior_residuals(problem.drawing, problem.sigma, state.projector, by_move);
  const int n_p = at.latents - at.projector;
  normal.h.block(at.projector, at.projector, n_p, n_p) += by_move.transpose() * by_move;
  normal.g.segment(at.projector, n_p) += by_move.transpose() * prior;
  normal.h.diagonal().head(at.projector).array() += 1;
  normal.g.head(at.projector) += state.z;
  normal.h.diagonal().tail(at.all - at.latents).array() += 1;
  for (std::size_t k = 0; k < state.latents.size(); ++k) {
    normal.g.segment<2>(at.latents + 2 * static_cast<int>(k)) += state.latents[k] / problem.repeatability_rad;
  }
  if (problem.split) {
    normal.g.tail<kMoved>() += state.moved.cwiseQuotient(moved_sigma(problem));
  }
  return normal;
}

void whiten(Problem& problem, const State& state) {
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const model::SteeredLook look = look_of(problem, state, k);
    for (ProblemPoint& point : problem.looks[k].points) {
      model::PixelDerivatives by;
      if (look.project(point.eye.p, by)) {
        const Eigen::Matrix2d covariance =
            point.eye.cov_x + by.by_point * point.eye.covariance * by.by_point.transpose();
        point.whiten = Eigen::Matrix2d(covariance.inverse()).llt().matrixU();
      }
    }
  }
}

double robust_scale(const Problem& problem, const State& state) {
  std::vector<double> squared;
  for (std::size_t k = 0; k < problem.looks.size(); ++k) {
    const model::SteeredLook look = look_of(problem, state, k);
    for (const ProblemPoint& point : problem.looks[k].points) {
      const auto r = residual(problem, state, k, point, look);
      squared.push_back(r ? r->panel.squaredNorm() : kBehind * kBehind);
    }
  }
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(squared.size() / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::sqrt(*middle / (2 * std::log(2.0)));  // median of chi-square with 2 degrees
}

}  // namespace raysteer::calib::steer
