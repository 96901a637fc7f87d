#include "calib/steer/evaluate.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "calib/model/steered_look.hpp"
#include "calib/steer/check.hpp"
#include "calib/steer/eye_points.hpp"
#include "calib/steer/predict.hpp"

namespace raysteer::calib::steer {
namespace {

struct Missed {
  Eigen::Vector3d p;                     ///< metres, rig frame
  Eigen::Vector2d at;                    ///< panel, -1 to 1
  Eigen::Vector2d error;                 ///< px
  Eigen::Matrix2d information;           ///< of the measurement: cameras' and panel's noise
  Eigen::Matrix<double, 3, 2> m_per_px;  ///< across the light
  Eigen::Matrix2d predicted;             ///< covariance that the solution states, px^2
  Eigen::Vector2d smooth = Eigen::Vector2d::Zero();
  Eigen::Matrix2d smooth_covariance = Eigen::Matrix2d::Zero();
  bool used = true;
};

std::vector<Missed> missed(const Solution& solution, const Look& look, const LookState& state) {
  const Eigen::MatrixXd held(solution.camera_parameters(), 0);
  const Eyes eyes(solution.cameras, held);
  const model::SteeredLook steered(solution.projector, look.command_rad, state.latent_rad);
  const Eigen::Vector2d half(solution.projector.lens.width / 2.0, solution.projector.lens.height / 2.0);
  std::vector<Missed> all;
  for (const LitPoint& point : look.points) {
    const auto seen = eyes.see(point);
    model::PixelDerivatives by;
    const auto x = seen ? steered.project(seen->p, by) : std::nullopt;
    if (!x) {
      continue;
    }
    const auto prediction = predict(solution, look.command_rad, seen->p, PointFrom::kCameras, std::nullopt, state);
    const Eigen::Matrix2d noise = point.cov_x + by.by_point * seen->covariance * by.by_point.transpose();
    all.push_back({.p = seen->p,
                   .at = point.x.cwiseQuotient(half) - Eigen::Vector2d::Ones(),
                   .error = *x - point.x,
                   .information = noise.inverse(),
                   .m_per_px = by.by_point.transpose() * (by.by_point * by.by_point.transpose()).inverse(),
                   .predicted = prediction->covariance});
  }
  return all;
}

/// 1 x y x^2 xy y^2 for either coordinate, as 2 x 12; only the first three where points are few.
Eigen::MatrixXd trend_terms(const Eigen::Vector2d& at, Eigen::Index terms) {
  const Eigen::Matrix<double, 6, 1> t{{1, at.x(), at.y(), at.x() * at.x(), at.x() * at.y(), at.y() * at.y()}};
  Eigen::MatrixXd both = Eigen::MatrixXd::Zero(2, 2 * terms);
  both.row(0).head(terms) = t.head(terms).transpose();
  both.row(1).tail(terms) = t.head(terms).transpose();
  return both;
}

void smooth(std::vector<Missed>& points) {
  const Eigen::Index terms = points.size() < 40 ? 3 : 6;
  for (int round = 0; round < 3; ++round) {
    Eigen::MatrixXd h = 1e-9 * Eigen::MatrixXd::Identity(2 * terms, 2 * terms);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(2 * terms);
    for (const Missed& point : points) {
      if (point.used) {
        const Eigen::MatrixXd t = trend_terms(point.at, terms);
        h += t.transpose() * point.information * t;
        g += t.transpose() * point.information * point.error;
      }
    }
    const Eigen::MatrixXd covariance = h.inverse();
    const Eigen::VectorXd trend = covariance * g;
    for (Missed& point : points) {
      const Eigen::MatrixXd t = trend_terms(point.at, terms);
      point.smooth = t * trend;
      point.smooth_covariance = t * covariance * t.transpose();
      const Eigen::Vector2d rest = point.error - point.smooth;
      point.used = rest.dot(point.information * rest) < 16;
    }
  }
}

double quantile(std::vector<double>& values, double share) {
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

}  // namespace

Result<Evaluation> evaluate(const Solution& solution, std::span<const Look> looks, std::span<const LookState> states) {
  if (looks.empty()) {
    return fail(RCode::kTooFewLooks, "no held-out looks to judge by; expected at least one");
  }
  Evaluation evaluation;
  std::vector<double> raw_px, raw_mm;
  std::vector<double>& px = evaluation.px;
  std::vector<double>& mm = evaluation.mm;
  std::size_t inside = 0;
  double squared = 0;
  double variance = 0;
  double stated = 0;
  for (std::size_t k = 0; k < looks.size(); ++k) {
    const Look& look = looks[k];
    RAYSTEER_TRY(check(look));
    std::vector<Missed> points = missed(solution, look, k < states.size() ? states[k] : LookState{});
    smooth(points);
    std::vector<double> here;
    std::vector<HeldOutPoint> kept;
    for (const Missed& point : points) {
      if (!point.used) {
        continue;
      }
      here.push_back(point.smooth.norm());
      kept.push_back({point.p, point.m_per_px * point.smooth});
      px.push_back(point.smooth.norm());
      mm.push_back(1e3 * (point.m_per_px * point.smooth).norm());
      raw_px.push_back(point.error.norm());
      raw_mm.push_back(1e3 * (point.m_per_px * point.error).norm());
      squared += point.smooth.squaredNorm();
      stated += point.predicted.trace();
      constexpr double kChiSquare95 = 5.991464547107979;
      const Eigen::Matrix2d expected = point.predicted + point.smooth_covariance;
      inside += point.smooth.dot(expected.ldlt().solve(point.smooth)) <= kChiSquare95 ? 1 : 0;
      variance += point.predicted.trace() + point.smooth_covariance.trace();
    }
    if (here.size() < 12) {
      return fail(RCode::kTooFewCorrespondences, "held-out look '" + look.name + "' has " +
                                                     std::to_string(here.size()) + " points that agree; expected 12");
    }
    evaluation.looks.push_back({look.name, quantile(here, 0.5), quantile(here, 0.95), std::move(kept)});
  }
  evaluation.points = px.size();
  evaluation.within_95 = static_cast<double>(inside) / static_cast<double>(px.size());
  evaluation.predicted_rms_px = std::sqrt(stated / static_cast<double>(px.size()));
  evaluation.normalised = squared / variance;
  evaluation.median_px = quantile(px, 0.5);
  evaluation.p95_px = quantile(px, 0.95);
  evaluation.median_mm = quantile(mm, 0.5);
  evaluation.p95_mm = quantile(mm, 0.95);
  evaluation.raw_median_px = quantile(raw_px, 0.5);
  evaluation.raw_p95_px = quantile(raw_px, 0.95);
  evaluation.raw_median_mm = quantile(raw_mm, 0.5);
  evaluation.raw_p95_mm = quantile(raw_mm, 0.95);
  return evaluation;
}

}  // namespace raysteer::calib::steer
