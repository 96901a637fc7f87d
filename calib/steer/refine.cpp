#include "calib/steer/refine.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "calib/model/steered_look.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr std::size_t kFewestDots = 4;
constexpr double kGate = 4;         // sigma, at least
constexpr double kFloorPx2 = 0.01;  // a dot's place on the panel is exact, what the model knows of it is not: 0.1 px

Status check(std::span<const Dot> dots, const Eigen::Vector2d& command_rad) {
  if (!command_rad.allFinite()) {
    return fail(RCode::kNotFinite, "the command of the look is not a number");
  }
  if (dots.size() < kFewestDots) {
    return fail(RCode::kTooFewCorrespondences,
                "got " + std::to_string(dots.size()) + " dots; expected at least " + std::to_string(kFewestDots));
  }
  for (const Dot& dot : dots) {
    if (!dot.x.allFinite() || !dot.p.allFinite() || !dot.covariance.allFinite()) {
      return fail(RCode::kNotFinite, "a dot's place is not a number");
    }
  }
  return ok();
}

/// Dots of one look, linear in its angles.
struct Sighting {
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();  ///< of the angles
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  double chi2 = 0;
  std::size_t used = 0;
  Eigen::Matrix<double, 2, Eigen::Dynamic> by_parameters;  ///< sum of J_angles^T W J_parameters, if asked for
};

struct Whitened {
  Eigen::Vector2d e;
  Eigen::Matrix2d by_angles;
  Eigen::Matrix2d whiten;
  model::PixelDerivatives by;
};

std::optional<Whitened> whitened(const model::SteeredLook& look, const Dot& dot) {
  Whitened w;
  const auto x = look.project(dot.p, w.by);
  if (!x) {
    return std::nullopt;
  }
  const Eigen::Matrix2d covariance =
      w.by.by_point * dot.covariance * w.by.by_point.transpose() + kFloorPx2 * Eigen::Matrix2d::Identity();
  w.whiten = Eigen::Matrix2d(covariance.inverse()).llt().matrixU();
  w.e = w.whiten * (*x - dot.x);
  w.by_angles = w.whiten * w.by.by_angles;
  return w;
}

/// `gate` in whitened units; beyond it a dot does not count.
Sighting sight(const Solution& solution, const model::SteeredLook& look, std::span<const Dot> dots, double gate,
               bool with_parameters) {
  Sighting sighting;
  const Eigen::Index n = solution.camera_parameters() + solution.projector_parameters();
  if (with_parameters) {
    sighting.by_parameters.setZero(2, n);
  }
  for (const Dot& dot : dots) {
    const auto w = whitened(look, dot);
    if (!w || !(w->e.norm() < gate)) {
      continue;
    }
    sighting.information += w->by_angles.transpose() * w->by_angles;
    sighting.gradient += w->by_angles.transpose() * w->e;
    sighting.chi2 += w->e.squaredNorm();
    ++sighting.used;
    if (with_parameters) {
      sighting.by_parameters +=
          w->by_angles.transpose() * w->whiten * prediction_by_parameters(solution, w->by, dot.p, PointFrom::kCameras);
    }
  }
  return sighting;
}

/// Dots farther out than this count as wrong ones: 4 sigma, or 4 times what dots are usually off by.
double gate_at(const model::SteeredLook& look, std::span<const Dot> dots) {
  std::vector<double> off;
  for (const Dot& dot : dots) {
    const auto w = whitened(look, dot);
    off.push_back(w ? w->e.norm() : std::numeric_limits<double>::infinity());
  }
  const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
  std::nth_element(off.begin(), middle, off.end());
  return kGate * std::max(1.0, *middle / 1.18);  // median of a Rayleigh
}

Error contradict(double rms) {
  return fail(RCode::kLookNotSolved, "dots are " + std::to_string(rms) +
                                         " times their noise away from any mirror position; expected about 1: they are "
                                         "another look's, or the rig is no longer as calibrated");
}

constexpr double kMostRms = 3;

}  // namespace

Result<RefinedLook> refine_look(const Solution& solution, const Eigen::Vector2d& command_rad, std::span<const Dot> dots,
                                double prior_rad) {
  RAYSTEER_TRY(check(dots, command_rad));
  RefinedLook refined;
  const Eigen::Matrix2d prior = Eigen::Matrix2d::Identity() / (prior_rad * prior_rad);
  Sighting sighting;
  for (int round = 0; round < 8; ++round) {
    const model::SteeredLook look(solution.projector, command_rad, refined.state.latent_rad);
    sighting = sight(solution, look, dots, gate_at(look, dots), round == 7);
    refined.state.latent_rad -=
        (sighting.information + prior).ldlt().solve(sighting.gradient + prior * refined.state.latent_rad);
  }
  const double degrees = std::max(1.0, 2.0 * static_cast<double>(sighting.used) - 2);
  refined.used = sighting.used;
  refined.whitened_rms = std::sqrt(sighting.chi2 / degrees);
  if (refined.used < kFewestDots || 2 * refined.used < dots.size() || !(refined.whitened_rms < kMostRms) ||
      !refined.state.latent_rad.allFinite()) {
    return contradict(refined.whitened_rms);
  }
  if (const double off = refined.state.latent_rad.cwiseAbs().maxCoeff(); off > kGate * prior_rad) {
    return fail(RCode::kLookNotSolved, "the dots say that the mirror stands " + std::to_string(1e3 * off) +
                                           " mrad away from its command; expected at most " +
                                           std::to_string(1e3 * kGate * prior_rad) +
                                           ": they are another look's, or the mirror did not go there");
  }
  const Eigen::Matrix2d covariance = (sighting.information + prior).inverse();
  refined.state.covariance_rad2 = covariance;
  refined.state.by_parameters = -covariance * sighting.by_parameters;
  return refined;
}

LookState Drift::at(const Solution& solution, const Eigen::Vector2d& command_rad) const {
  const Eigen::Vector2d angles = solution.projector.angles(command_rad);
  Eigen::Matrix<double, 2, 4> by_drift;
  by_drift << Eigen::Matrix2d::Identity(), Eigen::Matrix2d(angles.asDiagonal());
  LookState state;
  state.latent_rad = offset_rad + gain.cwiseProduct(angles);
  state.covariance_rad2 = by_drift * covariance * by_drift.transpose() +
                          solution.repeatability_rad * solution.repeatability_rad * Eigen::Matrix2d::Identity();
  return state;
}

Result<Drift> refine_drift(const Solution& solution, std::span<const DottedLook> looks, const DriftPrior& prior) {
  if (looks.empty()) {
    return fail(RCode::kTooFewCorrespondences, "no looks with dots; expected at least one");
  }
  for (const DottedLook& look : looks) {
    RAYSTEER_TRY(check(look.dots, look.command_rad));
  }
  // Unknown: offset 1, 2, gain 1, 2, and two angles a look with the mirror's repeatability as prior.
  const auto n = static_cast<Eigen::Index>(4 + 2 * looks.size());
  Eigen::VectorXd precision(n);
  precision.head<4>() << Eigen::Vector2d::Constant(1 / (prior.offset_rad * prior.offset_rad)),
      Eigen::Vector2d::Constant(1 / (prior.gain * prior.gain));
  precision.tail(n - 4).setConstant(1 / (solution.repeatability_rad * solution.repeatability_rad));
  Eigen::VectorXd unknown = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd h;
  double chi2 = 0;
  std::size_t used = 0;
  std::size_t given = 0;
  for (int round = 0; round < 8; ++round) {
    h = precision.asDiagonal();
    Eigen::VectorXd g = precision.cwiseProduct(unknown);
    chi2 = 0;
    used = 0;
    given = 0;
    for (std::size_t k = 0; k < looks.size(); ++k) {
      const Eigen::Vector2d angles = solution.projector.angles(looks[k].command_rad);
      Eigen::MatrixXd by = Eigen::MatrixXd::Zero(2, n);
      by.leftCols<4>() << Eigen::Matrix2d::Identity(), Eigen::Matrix2d(angles.asDiagonal());
      by.middleCols<2>(static_cast<Eigen::Index>(4 + 2 * k)).setIdentity();
      const model::SteeredLook look(solution.projector, looks[k].command_rad, by * unknown);
      const Sighting sighting = sight(solution, look, looks[k].dots, gate_at(look, looks[k].dots), false);
      h += by.transpose() * sighting.information * by;
      g += by.transpose() * sighting.gradient;
      chi2 += sighting.chi2;
      used += sighting.used;
      given += looks[k].dots.size();
    }
    unknown -= h.ldlt().solve(g);
  }
  Drift drift{.offset_rad = unknown.head<2>(), .gain = unknown.segment<2>(2)};
  drift.whitened_rms = std::sqrt(chi2 / std::max(1.0, 2.0 * static_cast<double>(used) - static_cast<double>(n)));
  if (!(drift.whitened_rms < kMostRms) || 2 * used < given || !unknown.allFinite()) {
    return contradict(drift.whitened_rms);
  }
  drift.covariance = h.inverse().topLeftCorner<4, 4>();
  return drift;
}

}  // namespace raysteer::calib::steer
