// Calibrations of ideal rigs, and what they miss at looks they never saw: for tests and campaigns of calib/steer.
//
// A trial knows the truth and measures with it. Points that cameras measure are measured by the solved cameras, as a
// rig would: light falls from the true projector, true cameras see it, solved cameras say where it is.
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calib/plan/looks.hpp"
#include "calib/steer/eye_points.hpp"
#include "calib/steer/predict.hpp"
#include "calib/steer/refine.hpp"
#include "calib/steer/solve.hpp"
#include "calib/steer/without_board.hpp"
#include "tests/support/drawn_rig.hpp"

namespace raysteer::support {

/// A board and its plan, which comes from the drawing alone.
struct PlannedBoard {
  DrawnRig drawn;
  std::vector<Eigen::Vector2d> commands;
  Eigen::Vector2d least_rad, most_rad;  ///< box round the usable commands
  calib::plan::Prediction prediction;
};

inline PlannedBoard planned_board(const std::string& name, int looks, double repeatability_rad = 20e-6,
                                  int candidates = 13) {
  PlannedBoard board{.drawn = drawn_rig(name), .commands = {}, .least_rad = {}, .most_rad = {}, .prediction = {}};
  board.drawn.drawing.tolerance.repeatability_rad = repeatability_rad;
  calib::plan::LookOptions options;
  options.looks = looks;
  options.held_out = 0;
  options.candidates = candidates;
  const calib::plan::ScenePlane floor{.normal = Eigen::Vector3d::UnitZ(), .distance_m = kFloorDepth};
  const auto plan = calib::plan::plan_looks(board.drawn.drawing, board.drawn.cameras, floor, options);
  if (!plan) {
    throw std::runtime_error(plan.error().message());
  }
  for (const calib::plan::PlannedLook& look : plan->looks) {
    board.commands.push_back(look.command_rad);
  }
  board.least_rad = plan->least_rad;
  board.most_rad = plan->most_rad;
  board.prediction = plan->prediction;
  return board;
}

/// Errors of predictions, pooled over points, looks and rigs.
struct Misses {
  std::vector<double> px;
  std::vector<double> mm;
  std::vector<double> normalised;  ///< squared error over the stated covariance: chi-square of 2 when honest

  double within_95() const {
    constexpr double kChiSquare95 = 5.991464547107979;
    const auto inside = std::ranges::count_if(normalised, [](double n) { return n <= kChiSquare95; });
    return static_cast<double>(inside) / static_cast<double>(normalised.size());
  }
  void add(const Misses& more) {
    px.insert(px.end(), more.px.begin(), more.px.end());
    mm.insert(mm.end(), more.mm.begin(), more.mm.end());
    normalised.insert(normalised.end(), more.normalised.begin(), more.normalised.end());
  }
};

/// The value below which the part `share` lies.
inline double quantile(std::vector<double> values, double share) {
  const auto at = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(at));
  return values[at];
}

inline double mean(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) {
    sum += value;
  }
  return sum / static_cast<double>(values.size());
}

class SteerTrial {
 public:
  /// Errors: what the solver says. `truth` is for later questions in both cases.
  SteerTrial(const PlannedBoard& board, std::uint64_t seed, const IdealOptions& options,
             const calib::steer::Options& solver = {})
      : board_(board), options_(options), seed_(seed), rig_(*draw_ideal(board.drawn.board, seed)) {
    if (options.relief) {
      boxes_ = ideal::boxes(seed, options.box_height);
    }
    auto observations = observe(rig_, board.commands, options, seed);
    // As a session's looks: one of which next to nothing was seen is left out before the solve.
    std::erase_if(observations.looks, [](const calib::steer::Look& look) { return look.points.size() < 12; });
    if (options.drawn_cameras) {
      observations.cameras = board.drawn.cameras;
      solution_.emplace(calib::steer::solve_without_board(observations, board.drawn.drawing, known_length(), solver));
    } else {
      solution_.emplace(calib::steer::solve(observations, board.drawn.drawing, solver));
    }
    if (*solution_) {
      by_z_ = Eigen::MatrixXd::Zero((*solution_)->camera_parameters(), 0);
    }
  }

  const Result<calib::steer::Solution>& solution() const { return *solution_; }
  const IdealRig& rig() const { return rig_; }

  /// Open loop, at random commands of the usable range: 5 x 5 pixels each.
  Misses unseen(int looks) const { return at_random(looks, 0); }
  /// After the loop was closed there with `dots` dots.
  Misses closed_loop(int looks, int dots = 20) const { return at_random(looks, dots); }

  /// Where the true rig's light of pixel x falls on the scene, if both true cameras see it. `angles`: true ones.
  std::optional<Eigen::Vector3d> lit(const sim::optics::LightPath& path, const Eigen::Vector2d& x) const {
    const auto out = path.leave(x);
    const auto p = out && out->passage.through ? ideal::meet(out->origin, out->direction, boxes_) : std::nullopt;
    return p && seen(*p) ? p : std::nullopt;
  }
  sim::optics::LightPath path(const Eigen::Vector2d& angles) const {
    return {rig_.truth.rig, {Radians(angles.x()), Radians(angles.y())}};
  }

  /// A true point as the solved cameras see it, with noise of the pixels.
  std::optional<calib::steer::EyePoint> eye_point(const Eigen::Vector3d& p, double noise_px, Noise& noise) const {
    return eye_point(p, noise_px, noise, (*solution_)->cameras);
  }
  std::optional<calib::steer::EyePoint> eye_point(const Eigen::Vector3d& p, double noise_px, Noise& noise,
                                                  const calib::model::Rig& cameras) const {
    return eye_point(p, noise_px, noise, cameras, by_z_);
  }
  std::optional<calib::steer::EyePoint> eye_point(const Eigen::Vector3d& p, double noise_px, Noise& noise,
                                                  const calib::model::Rig& cameras, const Eigen::MatrixXd& by_z) const {
    calib::steer::LitPoint point{.x = Eigen::Vector2d::Zero(), .q = {}, .cov_x = {}, .cov_q = {}};
    point.cov_x.setZero();
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto q = rig_.truth.rig.cameras[eye].project(p);
      if (!q) {
        return std::nullopt;
      }
      point.q[eye] = *q + ideal::normals(noise, noise_px);
      point.cov_q[eye] = std::pow(std::max(noise_px, 0.01), 2) * Eigen::Matrix2d::Identity();
    }
    return calib::steer::Eyes(cameras, by_z).see(point);
  }

  /// Dots over the panel as the rig would see them with the mirror at `angles`.
  std::vector<calib::steer::Dot> dots(const Eigen::Vector2d& angles, int count, Noise& noise) const {
    return dots(angles, count, noise, (*solution_)->cameras);
  }
  std::vector<calib::steer::Dot> dots(const Eigen::Vector2d& angles, int count, Noise& noise,
                                      const calib::model::Rig& cameras) const {
    const sim::optics::LightPath light = path(angles);
    const auto& lens = board_.drawn.drawing.projector.lens;
    std::vector<calib::steer::Dot> found;
    for (int attempt = 0; attempt < 10 * count && static_cast<int>(found.size()) < count; ++attempt) {
      const double i = noise.uniform(0, lens.width - 1);
      const double j = noise.uniform(0, lens.height - 1);
      const auto p = lit(light, {i, j});
      const auto point = p ? eye_point(*p, options_.noise_px, noise, cameras) : std::nullopt;
      if (point) {
        found.push_back({.x = {i, j}, .p = point->p, .covariance = point->covariance});
      }
    }
    return found;
  }

  /// What a prediction misses at each of 5 x 5 pixels with the mirror truly at `angles`.
  void measure(const Eigen::Vector2d& command, const Eigen::Vector2d& angles, const calib::steer::LookState& state,
               Noise& noise, Misses& misses) const {
    const sim::optics::LightPath light = path(angles);
    const auto& lens = board_.drawn.drawing.projector.lens;
    constexpr int kPixels = 5;
    for (int i = 0; i < kPixels; ++i) {
      for (int j = 0; j < kPixels; ++j) {
        const Eigen::Vector2d x((i + 0.5) * lens.width / kPixels - 0.5, (j + 0.5) * lens.height / kPixels - 0.5);
        const auto p = lit(light, x);
        const auto measured = p ? eye_point(*p, 0, noise) : std::nullopt;
        const auto predicted = measured ? calib::steer::predict(**solution_, command, measured->p,
                                                                calib::steer::PointFrom::kCameras, std::nullopt, state)
                                        : std::nullopt;
        if (!predicted) {
          continue;
        }
        const Eigen::Vector2d error = predicted->x - x;
        misses.px.push_back(error.norm());
        misses.normalised.push_back(error.dot(predicted->covariance.ldlt().solve(error)));
        // Where the light of the predicted pixel would truly fall, on the level of the point it was meant for.
        if (const auto out = light.leave(predicted->x)) {
          const Eigen::Vector3d at = out->origin + (p->z() - out->origin.z()) / out->direction.z() * out->direction;
          misses.mm.push_back(1000 * (at - *p).norm());
        }
      }
    }
  }

  /// A random command of the usable range at which the true picture's middle is seen by both cameras.
  Eigen::Vector2d random_command(Noise& noise) const {
    const auto& lens = board_.drawn.drawing.projector.lens;
    const Eigen::Vector2d middle((lens.width - 1) / 2.0, (lens.height - 1) / 2.0);
    for (int attempt = 0; attempt < 100; ++attempt) {
      const double i = noise.uniform(board_.least_rad.x(), board_.most_rad.x());
      const double j = noise.uniform(board_.least_rad.y(), board_.most_rad.y());
      if (lit(path(rig_.projector.angles({i, j})), middle)) {
        return {i, j};
      }
    }
    return (board_.least_rad + board_.most_rad) / 2;
  }

  /// What the solved cameras miss in a length on the floor, relative, and the same in sigmas of their covariance.
  struct LengthMiss {
    double relative = 0, sigmas = 0;
  };
  LengthMiss length_miss() const {
    Noise noise(seed_, 0x1e47);
    const std::vector<Eigen::Vector3d> places = two_places(noise);
    const Eigen::MatrixXd by_z = calib::steer::camera_prior((*solution_)->cameras);
    const auto a = eye_point(places[0], 0, noise, (*solution_)->cameras, by_z);
    const auto b = eye_point(places[1], 0, noise, (*solution_)->cameras, by_z);
    if (!a || !b) {
      return {.relative = 1, .sigmas = 1e3};
    }
    const double truth = (places[1] - places[0]).norm();
    const double error = (b->p - a->p).norm() - truth;
    const double sigma = ((b->p - a->p).normalized().transpose() * (b->p_by_z - a->p_by_z)).norm();
    return {.relative = error / truth, .sigmas = error / sigma};
  }

  const PlannedBoard& board() const { return board_; }
  const IdealOptions& options() const { return options_; }
  std::uint64_t seed() const { return seed_; }

 private:
  /// On the floor, at least a metre apart, where both eyes see them.
  std::vector<Eigen::Vector3d> two_places(Noise& noise) const {
    std::vector<Eigen::Vector3d> places;
    while (places.size() < 2) {
      const double x = noise.uniform(-3, 3);
      const double y = noise.uniform(-2, 2);
      const Eigen::Vector3d place(x, y, kFloorDepth);
      if (seen(place) && (places.empty() || (place - places[0]).norm() > 1)) {
        places.push_back(place);
      }
    }
    return places;
  }

  /// As somebody measured it, to half a millimetre.
  calib::steer::KnownLength known_length() const {
    Noise noise(seed_, 0x1e46);
    constexpr double kSigma = 0.5e-3;
    constexpr double kEndPx = 0.05;
    const double measured_wrong = kSigma * noise.normal();
    if (!options_.known_ends) {
      return {.metres = rig_.cameras.devices[1].T_device_rig.t.norm() + measured_wrong, .sigma_m = kSigma, .ends = {}};
    }
    const std::vector<Eigen::Vector3d> places = two_places(noise);
    std::array<calib::steer::LitPoint, 2> ends;
    for (std::size_t end = 0; end < 2; ++end) {
      ends[end].x.setZero();
      ends[end].cov_x.setZero();
      for (std::size_t eye = 0; eye < 2; ++eye) {
        ends[end].q[eye] = *rig_.truth.rig.cameras[eye].project(places[end]) + ideal::normals(noise, kEndPx);
        ends[end].cov_q[eye] = kEndPx * kEndPx * Eigen::Matrix2d::Identity();
      }
    }
    return {
        .metres = (places[1] - places[0]).norm() + measured_wrong, .sigma_m = kSigma, .ends = ends, .ends_off_px = 0};
  }

  Misses at_random(int looks, int dot_count) const {
    Misses misses;
    Noise noise(seed_, 0x7e57, static_cast<std::uint64_t>(dot_count));
    for (int k = 0; k < looks; ++k) {
      const Eigen::Vector2d command = random_command(noise);
      const Eigen::Vector2d angles = rig_.projector.angles(command) + ideal::normals(noise, options_.repeatability_rad);
      calib::steer::LookState state;
      if (dot_count > 0) {
        const auto refined = calib::steer::refine_look(**solution_, command, dots(angles, dot_count, noise));
        if (!refined) {
          continue;  // too few dots where cameras see next to nothing
        }
        state = refined->state;
      }
      measure(command, angles, state, noise, misses);
    }
    return misses;
  }

  bool seen(const Eigen::Vector3d& p) const {
    return std::ranges::all_of(rig_.truth.rig.cameras, [&](const sim::optics::TrueCamera& camera) {
      const auto q = camera.project(p);
      return q && q->x() > 0 && q->y() > 0 && q->x() < camera.width - 1 && q->y() < camera.height - 1;
    });
  }

  const PlannedBoard& board_;
  IdealOptions options_;
  std::uint64_t seed_;
  IdealRig rig_;
  std::vector<ideal::Box> boxes_;
  std::optional<Result<calib::steer::Solution>> solution_;
  Eigen::MatrixXd by_z_;
};

}  // namespace raysteer::support
