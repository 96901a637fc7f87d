#include "calib/steer/plane_or_depth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "calib/model/pose.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr std::size_t kFewest = 8;
constexpr int kRounds = 30;
constexpr double kMost = 20;       // a squared residual counts up to kMost (r - d)
constexpr double kMostWild = 0.1;  // share of pairs
constexpr double kBound = 3;       // whitened: from here on a pair pulls less (Cauchy)

double weight(double e2) { return 1 / (1 + e2 / (kBound * kBound)); }

/// b = H a~, whitened by both covariances.
class Homography {
 public:
  static constexpr int kResiduals = 2;

  Homography(std::span<const ViewPair> pairs, Lenses lenses) : open_(lenses == Lenses::kOpen) {
    // Linear start (Hartley and Zisserman, Multiple View Geometry, 4.1); normalised coordinates are of order one.
    Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
    for (const ViewPair& pair : pairs) {
      const Eigen::RowVector3d a = pair.a.homogeneous();
      Eigen::Matrix<double, 2, 9> rows = Eigen::Matrix<double, 2, 9>::Zero();
      rows.row(0) << a, Eigen::RowVector3d::Zero(), -pair.b.x() * a;
      rows.row(1) << Eigen::RowVector3d::Zero(), a, -pair.b.y() * a;
      normal += rows.transpose() * rows;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
    const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
    H_ << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  }

  Eigen::Vector2d residual(const ViewPair& pair) const {
    const Eigen::Vector3d u = H_ * (open_ ? bent(pair.a, lens_.head<4>()) : pair.a).homogeneous();
    const Eigen::Vector2d at = u.hnormalized();
    const Eigen::Vector2d b = open_ ? bent(pair.b, lens_.tail<4>()) : pair.b;
    Eigen::Matrix<double, 2, 3> by_u;
    by_u << Eigen::Matrix2d::Identity(), -at;
    const Eigen::Matrix2d by_a = by_u * H_.leftCols<2>() / u.z();
    const Eigen::Matrix2d covariance = pair.cov_b + by_a * pair.cov_a * by_a.transpose();
    return Eigen::Matrix2d(covariance.llt().matrixL()).triangularView<Eigen::Lower>().solve(at - b);
  }

  static constexpr int kParameters = 16;
  /// Moved along eight directions across itself, since its length means nothing; then k1 k2 p1 p2 of both views.
  Homography moved(const Eigen::Matrix<double, kParameters, 1>& by) const {
    Homography next = *this;
    Eigen::Map<Eigen::Matrix<double, 9, 1>> h(next.H_.data());
    const Eigen::Matrix<double, 9, 1> unit = h.normalized();
    const Eigen::Matrix<double, 9, 9> basis = Eigen::HouseholderQR<Eigen::Matrix<double, 9, 1>>(unit).householderQ() *
                                              Eigen::Matrix<double, 9, 9>::Identity();
    h = (unit + basis.rightCols<8>() * by.head<8>()).normalized();
    if (open_) {
      next.lens_ += by.tail<8>();
    }
    return next;
  }

 private:
  static Eigen::Vector2d bent(const Eigen::Vector2d& n, const Eigen::Vector4d& k) {
    const double r2 = n.squaredNorm();
    const double xy = 2 * n.x() * n.y();
    return (1 + r2 * (k[0] + r2 * k[1])) * n +
           Eigen::Vector2d(k[2] * xy + k[3] * (r2 + 2 * n.x() * n.x()), k[2] * (r2 + 2 * n.y() * n.y()) + k[3] * xy);
  }

  bool open_;
  Eigen::Matrix3d H_;
  Eigen::Matrix<double, 8, 1> lens_ = Eigen::Matrix<double, 8, 1>::Zero();
};

/// Sampson's distance of b~^T F a~ = 0; F = U diag(1, s, 0) V^T, so that it has rank 2 and seven numbers.
class Fundamental {
 public:
  static constexpr int kResiduals = 1;
  static constexpr int kParameters = 7;

  explicit Fundamental(const Eigen::Matrix3d& F) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    u_ = svd.matrixU();
    v_ = svd.matrixV();
    s_ = svd.singularValues()[1] / svd.singularValues()[0];
    compose();
  }

  Eigen::Matrix<double, 1, 1> residual(const ViewPair& pair) const {
    const Eigen::Vector3d a = pair.a.homogeneous();
    const Eigen::Vector3d b = pair.b.homogeneous();
    const Eigen::Vector2d by_b = (F_ * a).head<2>();
    const Eigen::Vector2d by_a = (F_.transpose() * b).head<2>();
    const double variance = by_b.dot(pair.cov_b * by_b) + by_a.dot(pair.cov_a * by_a);
    return Eigen::Matrix<double, 1, 1>(b.dot(F_ * a) / std::sqrt(std::max(variance, 1e-300)));
  }

  Fundamental moved(const Eigen::Matrix<double, kParameters, 1>& by) const {
    Fundamental next = *this;
    next.u_ = u_ * model::rotation_by(by.head<3>()).toRotationMatrix();
    next.v_ = v_ * model::rotation_by(by.segment<3>(3)).toRotationMatrix();
    next.s_ += by[6];
    next.compose();
    return next;
  }

 private:
  void compose() { F_ = u_ * Eigen::Vector3d(1, s_, 0).asDiagonal() * v_.transpose(); }

  Eigen::Matrix3d u_, v_, F_;
  double s_ = 1;
};

template <class Model>
double robust_cost(const Model& model, std::span<const ViewPair> pairs) {
  double sum = 0;
  for (const ViewPair& pair : pairs) {
    sum += kBound * kBound * std::log1p(model.residual(pair).squaredNorm() / (kBound * kBound));
  }
  return sum;
}

/// Levenberg-Marquardt on the Cauchy cost; derivatives by differences, since models are small.
template <class Model>
Model fitted(Model model, std::span<const ViewPair> pairs) {
  constexpr int kN = Model::kParameters;
  constexpr double kStep = 1e-7;
  using Move = Eigen::Matrix<double, kN, 1>;
  double damping = 1e-3;
  double cost = robust_cost(model, pairs);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Model> aside;
    for (int k = 0; k < kN; ++k) {
      aside.push_back(model.moved(kStep * Move::Unit(k)));
    }
    Eigen::Matrix<double, kN, kN> h = Eigen::Matrix<double, kN, kN>::Zero();
    Move g = Move::Zero();
    for (const ViewPair& pair : pairs) {
      const auto e = model.residual(pair);
      Eigen::Matrix<double, Model::kResiduals, kN> by;
      for (int k = 0; k < kN; ++k) {
        by.col(k) = (aside[static_cast<std::size_t>(k)].residual(pair) - e) / kStep;
      }
      const double w = weight(e.squaredNorm());
      h += w * by.transpose() * by;
      g += w * by.transpose() * e;
    }
    bool better = false;
    double gain = 0;
    for (int attempt = 0; attempt < 8 && !better; ++attempt) {
      Eigen::Matrix<double, kN, kN> damped = h;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += 1e-12 * h.trace();
      const Model next = model.moved(-damped.ldlt().solve(g));
      const double now = robust_cost(next, pairs);
      better = now < cost;
      if (better) {
        gain = cost - now;
        cost = now;
        model = next;
        damping = std::max(damping / 10, 1e-9);
      } else {
        damping *= 10;
      }
    }
    if (!better || gain < 1e-3) {
      break;
    }
  }
  return model;
}

template <class Model>
double gric(const Model& model, std::span<const ViewPair> pairs, int d, int k) {
  constexpr double kR = 4;
  const auto n = static_cast<double>(pairs.size());
  double sum = 0;
  for (const ViewPair& pair : pairs) {
    sum += std::min(model.residual(pair).squaredNorm(), kMost * (kR - d));
  }
  return sum + n * d * std::log(kR) + k * std::log(kR * n);
}

}  // namespace

Gric plane_or_depth(std::span<const ViewPair> pairs, const Eigen::Matrix3d& F, Lenses lenses) {
  if (pairs.size() < kFewest) {
    return {.points = pairs.size()};
  }
  // A pair off its own ray's line is a wild match, which no plane explains either: no sign of depth. Where many are,
  // it is F that is wrong.
  const Fundamental depth = fitted(Fundamental(F), pairs);
  std::vector<ViewPair> matched;
  std::ranges::copy_if(pairs, std::back_inserter(matched),
                       [&](const ViewPair& pair) { return depth.residual(pair).squaredNorm() < kMost; });
  const bool few_wild = static_cast<double>(matched.size()) > (1 - kMostWild) * static_cast<double>(pairs.size());
  const std::span<const ViewPair> judged = few_wild && matched.size() >= kFewest ? matched : pairs;
  return {.plane = gric(fitted(Homography(judged, lenses), judged), judged, 2, lenses == Lenses::kOpen ? 16 : 8),
          .depth = gric(depth, judged, 3, 7),
          .points = judged.size()};
}

Eigen::Matrix3d fundamental(const Eigen::Matrix3d& R, const Eigen::Vector3d& t) {
  Eigen::Matrix3d cross;
  cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
  return cross * R;
}

}  // namespace raysteer::calib::steer
