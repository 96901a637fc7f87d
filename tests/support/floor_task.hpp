// The floor task: rectangles on a floor whose datums were seen, none calibrated by itself.
#pragma once

#include <array>
#include <vector>

#include "calib/steer/room.hpp"
#include "tests/support/steer_trial.hpp"

namespace raysteer::support {

/// What was asked for and what was lit, over all stations. Lengths mm, angles degrees.
struct FloorErrors {
  std::vector<double> corner;
  std::vector<double> side;
  std::vector<double> angle;
  std::vector<double> normalised;  ///< corners' squared error over what was stated for it
  int refused = 0;                 ///< stations that the solved rig says it cannot light: beyond its reach
  int missed = 0;                  ///< stations that it thought it could

  void add(const FloorErrors& more) {
    corner.insert(corner.end(), more.corner.begin(), more.corner.end());
    side.insert(side.end(), more.side.begin(), more.side.end());
    angle.insert(angle.end(), more.angle.begin(), more.angle.end());
    normalised.insert(normalised.end(), more.normalised.begin(), more.normalised.end());
    refused += more.refused;
    missed += more.missed;
  }
};

struct FloorTask {
  Eigen::Vector2d area_m{6, 4};
  Eigen::Vector2d rectangle_m{0.5, 0.3125};
  int columns = 5;
  int rows = 3;
  int datum_columns = 4;  ///< on a grid of 4.8 x 4 m, those that both cameras see
  int datum_rows = 3;
  double datum_noise_px = 0.1;  ///< of a coded ring's centre, each coordinate
  double survey_m = 0.2e-3;     ///< of the datums' places, each coordinate
  int dots = 0;                 ///< closes the loop at each station where more than 0
};

/// The rig as a calibration could have left it: cameras off by what their covariance says; the projector as it is, so
/// that it is off in the room by what the cameras are.
inline calib::steer::Solution solution_of(const IdealRig& rig, std::uint64_t seed) {
  calib::steer::Solution solution;
  solution.projector = rig.projector;
  solution.cameras = calibrated_cameras(rig, seed);
  solution.repeatability_rad = 20e-6;
  const Eigen::Index cameras = solution.cameras.covariance.rows();
  const Eigen::Index all = cameras + solution.projector_parameters();
  solution.covariance = 1e-16 * Eigen::MatrixXd::Identity(all, all);
  solution.covariance.topLeftCorner(cameras, cameras) = solution.cameras.covariance;
  return solution;
}

/// The rig tied to the room by datums on the floor. The true room's frame is the true rig's, and the fit starts a
/// little off it.
inline std::optional<calib::steer::InRoom> tied_to_room(const IdealRig& rig, const calib::steer::Solution& solution,
                                                        const FloorTask& task, Noise& noise) {
  std::vector<calib::steer::RoomPoint> seen;
  for (int k = 0; k < task.datum_columns * task.datum_rows; ++k) {
    const double x = -2.2 + 4.8 * (k % task.datum_columns) / (task.datum_columns - 1.0);
    const int row = k / task.datum_columns;
    const double y = -2 + 4.0 * row / (task.datum_rows - 1.0);
    calib::steer::RoomPoint datum{.p_room = {x, y, kFloorDepth}, .covariance = {}, .q = {}, .cov_q = {}};
    datum.covariance = std::pow(task.survey_m, 2) * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d stands = datum.p_room + task.survey_m * Eigen::Vector3d(noise.normal(), noise.normal(), 0);
    bool inside = true;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      const auto& camera = rig.truth.rig.cameras[eye];
      const auto q = camera.project(stands);
      inside = inside && q && q->minCoeff() > 30 && q->x() < camera.width - 31 && q->y() < camera.height - 31;
      datum.q[eye] = q.value_or(Eigen::Vector2d::Zero()) + ideal::normals(noise, task.datum_noise_px);
      datum.cov_q[eye] = std::pow(task.datum_noise_px, 2) * Eigen::Matrix2d::Identity();
    }
    if (inside) {
      seen.push_back(datum);
    }
  }
  const calib::model::Pose start{calib::model::rotation_by({0.002, -0.003, 0.001}), {0.004, 0.003, -0.005}};
  auto tied = calib::steer::tie_to_room(solution, seen, start);
  return tied ? std::optional(*std::move(tied)) : std::nullopt;
}

inline std::optional<calib::steer::InRoom> tied_to_room(const SteerTrial& trial, const FloorTask& task, Noise& noise) {
  return tied_to_room(trial.rig(), *trial.solution(), task, noise);
}

/// The allowed command that brings p to the picture's middle, or as near as it goes.
inline Eigen::Vector2d aimed(const calib::model::SteeredProjector& projector, const Eigen::Vector3d& p) {
  const Eigen::Vector2d middle((projector.lens.width - 1) / 2.0, (projector.lens.height - 1) / 2.0);
  Eigen::Vector2d command = (projector.least_rad + projector.most_rad) / 2;
  constexpr double kStep = 1e-5;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const auto x = projector.at(command).project(p);
    const auto x1 = projector.at(command + Eigen::Vector2d(kStep, 0)).project(p);
    const auto x2 = projector.at(command + Eigen::Vector2d(0, kStep)).project(p);
    if (!x || !x1 || !x2) {
      break;
    }
    Eigen::Matrix2d J;
    J << (*x1 - *x) / kStep, (*x2 - *x) / kStep;
    Eigen::Vector2d step = J.inverse() * (*x - middle);
    step *= std::min(1.0, 0.2 / std::max(step.norm(), 1e-12));
    command = (command - step).cwiseMax(projector.least_rad).cwiseMin(projector.most_rad);
  }
  return command;
}

inline double corner_angle(const Eigen::Vector2d& before, const Eigen::Vector2d& corner, const Eigen::Vector2d& after) {
  const Eigen::Vector2d a = before - corner;
  const Eigen::Vector2d b = after - corner;
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)) * 180 / 3.14159265358979323846;
}

/// Each station's rectangle is predicted from the room's coordinates, lit by the true rig, and measured where it falls.
inline FloorErrors floor_errors(const SteerTrial& trial, const FloorTask& task = {}) {
  FloorErrors errors;
  Noise noise(trial.seed(), 0xf1);
  const auto room = tied_to_room(trial, task, noise);
  if (!room) {
    errors.refused = task.columns * task.rows;
    return errors;
  }
  const auto& lens = trial.board().drawn.drawing.projector.lens;
  const Eigen::Vector2d spread = task.area_m - task.rectangle_m;
  for (int station = 0; station < task.columns * task.rows; ++station) {
    const int column = station % task.columns;
    const int row = station / task.columns;
    const Eigen::Vector2d centre(spread.x() * (column / (task.columns - 1.0) - 0.5),
                                 spread.y() * (row / (task.rows - 1.0) - 0.5));
    const Eigen::Vector2d command =
        aimed(room->solution.projector, room->T_rig_room * Eigen::Vector3d(centre.x(), centre.y(), kFloorDepth));
    const Eigen::Vector2d angles =
        trial.rig().projector.angles(command) + ideal::normals(noise, trial.options().repeatability_rad);
    calib::steer::LookState state;
    if (task.dots > 0) {
      const auto refined = calib::steer::refine_look(room->solution, command,
                                                     trial.dots(angles, task.dots, noise, room->solution.cameras));
      state = refined ? refined->state : state;
    }
    const sim::optics::LightPath light = trial.path(angles);
    std::array<Eigen::Vector2d, 4> wanted;
    std::array<Eigen::Vector2d, 4> lit;
    std::array<Eigen::Matrix2d, 4> stated;
    // Of the outlines, for mirrors are not where they are drawn, and no calibration sees their edges.
    constexpr double kSpare = 0.1;
    const calib::model::MirrorOutlines outlines(room->solution.projector, room->solution.projector.angles(command));
    bool reachable = true;
    bool lights = true;
    for (std::size_t k = 0; k < 4; ++k) {
      const Eigen::Vector2d sign(k == 0 || k == 3 ? -0.5 : 0.5, k < 2 ? -0.5 : 0.5);
      wanted[k] = centre + sign.cwiseProduct(task.rectangle_m);
      const auto predicted = calib::steer::predict_in_room(*room, command, {wanted[k].x(), wanted[k].y(), kFloorDepth},
                                                           Eigen::Vector3d::UnitZ(), state);
      const auto out = predicted ? light.leave(predicted->x) : std::nullopt;
      reachable = reachable && predicted && predicted->x.minCoeff() > 0 && predicted->x.x() < lens.width - 1 &&
                  predicted->x.y() < lens.height - 1 && outlines.slack(predicted->x) > kSpare;
      lights = lights && out && out->passage.through;
      if (out) {
        stated[k] = *predicted->covariance_mm2();
        lit[k] = (out->origin + (kFloorDepth - out->origin.z()) / out->direction.z() * out->direction).head<2>();
      }
    }
    errors.refused += reachable ? 0 : 1;
    errors.missed += reachable && !lights ? 1 : 0;
    if (!reachable || !lights) {
      continue;
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      const std::size_t before = (k + 3) % 4;
      errors.corner.push_back(1000 * (lit[k] - wanted[k]).norm());
      const Eigen::Vector3d off(lit[k].x() - wanted[k].x(), lit[k].y() - wanted[k].y(), 0);
      const Eigen::Vector2d along = 1000 *
                                    calib::model::tangents(room->T_rig_room.q * Eigen::Vector3d::UnitZ()).transpose() *
                                    (room->T_rig_room.q * off);
      errors.normalised.push_back(along.dot(stated[k].ldlt().solve(along)));
      errors.side.push_back(1000 * std::abs((lit[next] - lit[k]).norm() - (wanted[next] - wanted[k]).norm()));
      errors.angle.push_back(std::abs(corner_angle(lit[before], lit[k], lit[next]) -
                                      corner_angle(wanted[before], wanted[k], wanted[next])));
    }
  }
  return errors;
}

}  // namespace raysteer::support
