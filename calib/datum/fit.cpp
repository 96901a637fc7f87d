#include "calib/datum/fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace raysteer::calib::datum {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kLeastSpread = 0.01;  // of the second longest extent against the longest; less is a line

// Umeyama (1991), all alike.
bool start_from(const Pairs& pairs, const Freedom& freedom, Fit& fit) {
  std::vector<Eigen::Index> used;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (std::ranges::find(freedom.moved, i) == freedom.moved.end()) {
      used.push_back(static_cast<Eigen::Index>(i));
    }
  }
  if (used.size() < 3) {
    return false;
  }
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(used.size()));
  Eigen::Matrix3Xd to(3, static_cast<Eigen::Index>(used.size()));
  for (std::size_t k = 0; k < used.size(); ++k) {
    from.col(static_cast<Eigen::Index>(k)) = pairs.measured[static_cast<std::size_t>(used[k])];
    to.col(static_cast<Eigen::Index>(k)) = pairs.surveyed[static_cast<std::size_t>(used[k])];
  }
  const Eigen::Matrix3Xd spread = to.colwise() - to.rowwise().mean();
  const Vector3d extents = spread.jacobiSvd().singularValues();
  if (!(extents(1) > kLeastSpread * extents(0))) {
    return false;
  }
  const Eigen::Matrix4d start = Eigen::umeyama(from, to, freedom.scale);
  if (!start.allFinite()) {
    return false;
  }
  const Matrix3d turned = start.topLeftCorner<3, 3>();
  fit.scale = std::cbrt(turned.determinant());
  fit.T_room_rig.q = Eigen::Quaterniond(Matrix3d(turned / fit.scale)).normalized();
  fit.T_room_rig.t = start.topRightCorner<3, 1>();
  return fit.scale > 0.1 && fit.scale < 10;
}

void take_misses(const Pairs& pairs, const Freedom& freedom, Fit& fit) {
  fit.misses.clear();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    fit.misses.push_back(fit.T_room_rig.t + fit.scale * (fit.T_room_rig.q * pairs.measured[i]) - pairs.surveyed[i]);
  }
  for (std::size_t k = 0; k < freedom.moved.size(); ++k) {
    fit.misses[freedom.moved[k]] -= fit.moved[k];
  }
}

VectorXd stacked(const std::vector<Vector3d>& vectors) {
  VectorXd all(3 * static_cast<Eigen::Index>(vectors.size()));
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    all.segment<3>(3 * static_cast<Eigen::Index>(i)) = vectors[i];
  }
  return all;
}

// How the misses change with the increment (model::moved_by), the scale and the moves.
MatrixXd slopes(const Pairs& pairs, const Freedom& freedom, const Fit& fit) {
  const auto n = static_cast<Eigen::Index>(pairs.size());
  const Eigen::Index unknowns = 6 + (freedom.scale ? 1 : 0) + 3 * static_cast<Eigen::Index>(freedom.moved.size());
  MatrixXd by = MatrixXd::Zero(3 * n, unknowns);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d arm = fit.T_room_rig.q * pairs.measured[static_cast<std::size_t>(i)];
    const Vector3d scaled = fit.scale * arm;
    by.block<3, 3>(3 * i, 0) << 0, scaled.z(), -scaled.y(), -scaled.z(), 0, scaled.x(), scaled.y(), -scaled.x(), 0;
    by.block<3, 3>(3 * i, 3).setIdentity();
    if (freedom.scale) {
      by.block<3, 1>(3 * i, 6) = arm;
    }
  }
  for (std::size_t k = 0; k < freedom.moved.size(); ++k) {
    const Eigen::Index column = 6 + (freedom.scale ? 1 : 0) + 3 * static_cast<Eigen::Index>(k);
    by.block<3, 3>(3 * static_cast<Eigen::Index>(freedom.moved[k]), column) = -Matrix3d::Identity();
  }
  return by;
}

MatrixXd covariance(const Pairs& pairs, const Fit& fit) {
  const auto n = static_cast<Eigen::Index>(pairs.size());
  MatrixXd turn = MatrixXd::Zero(3 * n, 3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    turn.block<3, 3>(3 * i, 3 * i) = fit.scale * fit.T_room_rig.rotation();
  }
  return turn * pairs.cov_measured * turn.transpose() + pairs.cov_surveyed;
}

/// By the normal deviate of the same probability.
double chi_square_at(int dof, double deviate) {
  if (dof <= 0) {
    return 0;
  }
  const double spread = 2.0 / (9.0 * dof);
  return dof * std::pow(1 - spread + deviate * std::sqrt(spread), 3);
}

}  // namespace

std::optional<Fit> fit(const Pairs& pairs, const Freedom& freedom) {
  Fit fit;
  if (!start_from(pairs, freedom, fit)) {
    return std::nullopt;
  }
  fit.moved.assign(freedom.moved.size(), Vector3d::Zero());
  constexpr int kIterations = 4;
  for (int i = 0; i <= kIterations; ++i) {
    take_misses(pairs, freedom, fit);
    const MatrixXd cov = covariance(pairs, fit);
    const Eigen::LLT<MatrixXd> llt(cov);
    const MatrixXd by = slopes(pairs, freedom, fit);
    fit.dof = static_cast<int>(by.rows() - by.cols());
    if (llt.info() != Eigen::Success || fit.dof < 0) {
      return std::nullopt;
    }
    const MatrixXd white = llt.matrixL().solve(by);
    const VectorXd misses = llt.matrixL().solve(stacked(fit.misses));
    const MatrixXd normal = white.transpose() * white;
    const Eigen::LLT<MatrixXd> solver(normal);
    if (solver.info() != Eigen::Success) {
      return std::nullopt;
    }
    if (i == kIterations) {
      fit.cov = solver.solve(MatrixXd::Identity(by.cols(), by.cols()));
      fit.gain = -solver.solve(by.transpose() * llt.solve(MatrixXd::Identity(by.rows(), by.rows())));
      fit.sigmas = cov.diagonal().cwiseSqrt();
      fit.chi_square = misses.squaredNorm();
      break;
    }
    const VectorXd step = -solver.solve(white.transpose() * misses);
    if (!step.allFinite()) {
      return std::nullopt;
    }
    fit.T_room_rig = model::moved_by(fit.T_room_rig, step.head<6>());
    if (freedom.scale) {
      fit.scale += step(6);
    }
    for (std::size_t k = 0; k < fit.moved.size(); ++k) {
      fit.moved[k] += step.segment<3>(6 + (freedom.scale ? 1 : 0) + 3 * static_cast<Eigen::Index>(k));
    }
  }
  fit.faces = true;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    fit.faces = fit.faces && pairs.normals[i].dot(fit.T_room_rig.t - pairs.surveyed[i]) > 0;
  }
  return std::isfinite(fit.chi_square) ? std::optional(fit) : std::nullopt;
}

double acceptable(int dof) { return chi_square_at(dof, 4.265); }
double unsuspicious(int dof) { return chi_square_at(dof, 3.090); }

}  // namespace raysteer::calib::datum
