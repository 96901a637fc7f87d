#include "calib/scene/refit_pose.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "calib/scene/epipolar.hpp"

namespace raysteer::calib::scene {
namespace {

using Vector5 = Eigen::Matrix<double, 5, 1>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr std::size_t kFewestMatches = 200;
constexpr std::size_t kFirstMatches = 20000;
constexpr double kClusterPx = 64;
/// No scan is better than this; keeps weights finite where matches are exact.
constexpr double kLeastSigmaPx = 0.01;
/// 99.9999 % of chi-square with 5 degrees of freedom: one false alarm in a million healthy scans.
constexpr double kChiSquareBound = 35.9;
/// A smaller change of the disagreement than this is not worth a warning, however sure we are of it: two sound
/// calibrations of one camera may differ by 0.3 px at 95 % (algorithms 1.4), two cameras by 0.4 px, 0.2 px RMS; and
/// lens models that are a little wrong add to that. (2026: five looks of a camera-projector pair that never moved show
/// 0.08 to 0.17 px, the stereo pair that did 0.37 px.)
constexpr double kWorthPx = 0.25;

/// Two directions perpendicular to the baseline.
Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& direction) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.unitOrthogonal();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

model::Pose moved_by(const model::Pose& pose, const Vector5& delta) {
  const double length = pose.t.norm();
  const Eigen::Vector3d direction = pose.t / length;
  const double angle = delta.head<3>().norm();
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(angle, angle > 0 ? Eigen::Vector3d(delta.head<3>() / angle) : Eigen::Vector3d::UnitX()));
  return {(turn * pose.q).normalized(), length * (direction + tangents(direction) * delta.tail<2>()).normalized()};
}

/// Disagreement of one pair of rays in px, and its derivative by the pose. The normalising gradient counts as
/// constant: its change is of second order where rays nearly meet.
struct Row {
  double d = 0;
  Vector5 by_pose = Vector5::Zero();
};

class Epipolar {
 public:
  explicit Epipolar(const TwoViews& views)
      : R_(views.T_right_left.rotation()),
        t_(views.T_right_left.t.normalized()),
        basis_(tangents(t_)),
        scale_(std::numbers::sqrt2 * (views.left.fx + views.left.fy + views.right.fx + views.right.fy) / 4) {}

  Row row(const RayPair& ray) const {
    const Eigen::Vector3d n = ray.right.homogeneous();
    const Eigen::Vector3d r = R_ * ray.left.homogeneous();
    const Eigen::Vector3d line_right = t_.cross(r);
    const Eigen::Vector3d a = n.cross(t_);  // e = n . (t x r) = a . r
    const Eigen::Vector3d line_left = R_.transpose() * a;
    const double gradient = std::sqrt(line_right.head<2>().squaredNorm() + line_left.head<2>().squaredNorm());
    Row row;
    row.d = scale_ * a.dot(r) / gradient;
    row.by_pose.head<3>() = scale_ / gradient * r.cross(a);
    row.by_pose.tail<2>() = scale_ / gradient * (basis_.transpose() * r.cross(n));
    return row;
  }

 private:
  Eigen::Matrix3d R_;
  Eigen::Vector3d t_;
  Eigen::Matrix<double, 3, 2> basis_;
  double scale_;
};

/// Cauchy weight: 2 sigma costs half.
double weight_of(double d, double sigma) { return 1 / (1 + d * d / (4 * sigma * sigma)); }

std::uint32_t cluster_of(const Match& match) {
  return static_cast<std::uint32_t>(std::max(0.0, match.q_left.y() / kClusterPx)) << 16 |
         static_cast<std::uint32_t>(std::max(0.0, match.q_left.x() / kClusterPx));
}

double spread(const TwoViews& views, std::span<const RayPair> rays) {
  return robust_sigma(epipolar_disagreement(views, rays));
}

/// Moves the pose until a step is smaller than `least_step` (rad).
Status settle(TwoViews& views, std::span<const RayPair> rays, double least_step) {
  constexpr int kMostSteps = 30;
  for (int step_number = 0; step_number < kMostSteps; ++step_number) {
    const double sigma = std::max(spread(views, rays), kLeastSigmaPx);
    const Epipolar epipolar(views);
    Matrix5 normal = Matrix5::Zero();
    Vector5 right_side = Vector5::Zero();
    for (const RayPair& ray : rays) {
      const Row row = epipolar.row(ray);
      const double weight = weight_of(row.d, sigma);
      normal.noalias() += weight * row.by_pose * row.by_pose.transpose();
      right_side -= weight * row.d * row.by_pose;
    }
    const Vector5 step = normal.ldlt().solve(right_side);
    if (!step.allFinite() || step.norm() > 1) {
      return fail(RCode::kSolverDiverged, "the refit of the relative pose ran away");
    }
    views.T_right_left = moved_by(views.T_right_left, step);
    if (step.norm() < least_step) {
      break;
    }
  }
  return ok();
}

/// What the calibration's uncertainty alone would make of a refit: the five pose numbers as a linear function of
/// the rig's parameters, on a few thousand matches.
Eigen::MatrixXd refit_by_parameters(const model::Rig& rig, std::size_t left, std::size_t right, const TwoViews& views,
                                    std::span<const Match> matches) {
  constexpr std::size_t kSamples = 1500;
  std::vector<Match> sample;
  for (std::size_t k = 0; k < matches.size(); k += std::max<std::size_t>(1, matches.size() / kSamples)) {
    sample.push_back(matches[k]);
  }
  const std::vector<RayPair> rays = ray_pairs(views, sample);
  const std::vector<double> d0 = epipolar_disagreement(views, rays);
  const Epipolar epipolar(views);
  Matrix5 normal = Matrix5::Zero();
  std::vector<Vector5> rows(sample.size(), Vector5::Zero());
  for (std::size_t k = 0; k < sample.size(); ++k) {
    if (rays[k].valid()) {
      rows[k] = epipolar.row(rays[k]).by_pose;
      normal += rows[k] * rows[k].transpose();
    }
  }
  Eigen::MatrixXd by_parameters = Eigen::MatrixXd::Zero(5, rig.covariance.cols());
  for (const std::size_t index : {left, right}) {
    const bool with_pose = index > 0;
    for (int p = 0; p < rig.count(index); ++p) {
      const int column = rig.offset(index) + p;
      const double step = std::sqrt(rig.covariance(column, column));
      if (!(step > 0)) {
        continue;
      }
      Eigen::VectorXd delta = Eigen::VectorXd::Zero(rig.count(index));
      delta[p] = step;
      model::Rig shifted;
      shifted.devices = rig.devices;
      shifted.devices[index] = model::perturbed(rig.devices[index], delta, with_pose);
      const Result<TwoViews> other = two_views(shifted, left, right);
      if (!other) {
        continue;
      }
      const std::vector<double> d = epipolar_disagreement(*other, ray_pairs(*other, sample));
      Vector5 right_side = Vector5::Zero();
      for (std::size_t k = 0; k < sample.size(); ++k) {
        if (std::isfinite(d[k]) && std::isfinite(d0[k])) {
          right_side += rows[k] * (d[k] - d0[k]);
        }
      }
      by_parameters.col(column) = normal.ldlt().solve(right_side) / step;
    }
  }
  return by_parameters;
}

}  // namespace

Result<PoseRefit> refit_pose(const model::Rig& rig, std::size_t left, std::size_t right, std::span<const Match> matches,
                             std::span<const RayPair> rays) {
  RAYSTEER_CHECK(matches.size() == rays.size());
  Result<TwoViews> calibrated = two_views(rig, left, right);
  if (!calibrated) {
    return calibrated.error();
  }
  std::vector<Match> fitted;
  std::vector<RayPair> fitted_rays, held_out_rays;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (!rays[k].valid()) {
      continue;
    }
    if (is_held_out(matches[k])) {
      held_out_rays.push_back(rays[k]);
    } else {
      fitted.push_back(matches[k]);
      fitted_rays.push_back(rays[k]);
    }
  }
  if (fitted.size() < kFewestMatches || held_out_rays.size() < kFewestMatches / 2) {
    return fail(RCode::kTooFewMatches, std::to_string(matches.size()) + " matches, a refit of the pose needs " +
                                           std::to_string(2 * kFewestMatches));
  }

  TwoViews views = *calibrated;
  std::vector<RayPair> few;  // most of the way is found with a part of the matches
  for (std::size_t k = 0; k < fitted_rays.size(); k += 1 + fitted_rays.size() / kFirstMatches) {
    few.push_back(fitted_rays[k]);
  }
  RAYSTEER_TRY(settle(views, few, 1e-5));
  RAYSTEER_TRY(settle(views, fitted_rays, 1e-7));

  // Sandwich covariance over clusters of the image.
  const double sigma = std::max(spread(views, fitted_rays), kLeastSigmaPx);
  const Epipolar epipolar(views);
  std::map<std::uint32_t, Vector5> scores;
  double effect = 0;
  const std::vector<double> before = epipolar_disagreement(*calibrated, fitted_rays);
  Matrix5 normal = Matrix5::Zero();
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    const Row row = epipolar.row(fitted_rays[k]);
    const double weight = weight_of(row.d, sigma);
    normal.noalias() += weight * row.by_pose * row.by_pose.transpose();
    scores.try_emplace(cluster_of(fitted[k]), Vector5::Zero()).first->second += weight * row.d * row.by_pose;
    effect += (before[k] - row.d) * (before[k] - row.d);
  }
  Matrix5 meat = Matrix5::Zero();
  for (const auto& [cell, score] : scores) {
    meat.noalias() += score * score.transpose();
  }
  const Matrix5 inverse = normal.ldlt().solve(Matrix5::Identity());

  PoseRefit refit;
  refit.T_right_left = views.T_right_left;
  refit.covariance = inverse * meat * inverse;
  refit.fitted = fitted.size();
  refit.held_out = held_out_rays.size();
  refit.held_out_before_px = spread(*calibrated, held_out_rays);
  refit.held_out_after_px = spread(views, held_out_rays);
  refit.effect_px = std::sqrt(effect / static_cast<double>(fitted.size()));

  // The move, in the calibrated pose's own five numbers.
  Vector5 move;
  const Eigen::AngleAxisd turn(views.T_right_left.q * calibrated->T_right_left.q.conjugate());
  const Eigen::Vector3d old_direction = calibrated->T_right_left.t.normalized();
  const Eigen::Vector3d new_direction = views.T_right_left.t.normalized();
  move << turn.angle() * turn.axis(), tangents(old_direction).transpose() * (new_direction - old_direction);
  refit.moved_rad = turn.angle();
  refit.baseline_turned_rad = std::atan2(old_direction.cross(new_direction).norm(), old_direction.dot(new_direction));
  Matrix5 uncertainty = refit.covariance;
  if (rig.covariance.size() > 0) {
    const Eigen::MatrixXd by_parameters = refit_by_parameters(rig, left, right, *calibrated, fitted);
    uncertainty += by_parameters * rig.covariance * by_parameters.transpose();
  }
  const Eigen::Vector3d axis = turn.axis();
  refit.moved_sigma_rad = std::sqrt(axis.dot(uncertainty.topLeftCorner<3, 3>() * axis));
  refit.chi_square = move.dot(uncertainty.ldlt().solve(move));
  refit.moved = refit.chi_square > kChiSquareBound && refit.effect_px > kWorthPx;
  return refit;
}

}  // namespace raysteer::calib::scene
