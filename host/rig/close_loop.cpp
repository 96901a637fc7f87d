#include "host/rig/close_loop.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "calib/steer/eye_points.hpp"
#include "host/rig/verify.hpp"

namespace raysteer::host::rig {
namespace {

using calib::steer::Dot;
using calib::steer::Drift;
using calib::steer::InRoom;
using calib::steer::LitPoint;
using calib::steer::Look;
using calib::steer::LookState;
using calib::steer::Solution;

/// A drift is said when chance alone would show it once in 1,000 times: chi-square of four.
constexpr double kSureOfDrift = 18.47;
constexpr double kDotNoisePx = 0.1;  // of a disc 9 panel px wide (algorithms 1.1)

/// The station's bound with another state, the station left as it is.
Result<double> bound(const InRoom& rig, AimedStation station, LookState state) {
  RAYSTEER_TRY(set_bounds(rig, std::move(state), station));
  return station.worst_95_mm;
}

/// The command at whose angles the mirror stands when it is `latent_rad` off those of `command_rad`. Curves are nearly
/// straight with slope 1, so each round leaves a fiftieth.
Eigen::Vector2d standing_as(const calib::model::SteeredProjector& projector, const Eigen::Vector2d& command_rad,
                            const Eigen::Vector2d& latent_rad) {
  const Eigen::Vector2d wanted = projector.angles(command_rad) + latent_rad;
  Eigen::Vector2d command = command_rad + latent_rad;
  for (int round = 0; round < 10; ++round) {
    command += wanted - projector.angles(command);
  }
  return command;
}

Status apply(const InRoom& rig, LookState state, AimedStation& station) {
  station.station.stands_as_rad = standing_as(rig.solution.projector, *station.station.command_rad, state.latent_rad);
  return set_bounds(rig, std::move(state), station);
}

bool sure(const Drift& drift) {
  Eigen::Vector4d by;
  by << drift.offset_rad, drift.gain;
  return by.dot(drift.covariance.ldlt().solve(by)) > kSureOfDrift;
}

}  // namespace

std::vector<Dot> dots_of(const Solution& solution, const Look& look, int count) {
  const Eigen::MatrixXd held(solution.camera_parameters(), 0);
  const calib::steer::Eyes eyes(solution.cameras, held);
  // Each next one is the farthest from those that were taken, the first one from the picture's middle.
  const Eigen::Vector2d middle(0.5 * solution.projector.lens.width, 0.5 * solution.projector.lens.height);
  std::vector<double> distance;
  std::ranges::transform(look.points, std::back_inserter(distance),
                         [&](const LitPoint& point) { return (point.x - middle).norm(); });
  std::vector<Dot> dots;
  while (static_cast<int>(dots.size()) < count && !distance.empty()) {
    const auto farthest = std::ranges::max_element(distance);
    if (!(*farthest > 0)) {
      break;
    }
    const LitPoint& point = look.points[static_cast<std::size_t>(farthest - distance.begin())];
    for (std::size_t k = 0; k < distance.size(); ++k) {
      const double away = (look.points[k].x - point.x).norm();
      distance[k] = dots.empty() ? away : std::min(distance[k], away);
    }
    *farthest = 0;
    if (const auto seen = eyes.see(point)) {
      dots.push_back({.x = point.x, .p = seen->p, .covariance = seen->covariance});
    }
  }
  return dots;
}

double closed_loop_95_mm(const InRoom& rig, const AimedStation& station) {
  const Solution& solution = rig.solution;
  const Eigen::MatrixXd held(solution.camera_parameters(), 0);
  const calib::steer::Eyes eyes(solution.cameras, held);
  const calib::steer::Surface plane{.point = station.station.T_rig_plane.t,
                                    .normal = rig.T_rig_room.q * station.normals_room[0]};
  std::vector<Dot> dots;
  constexpr int kColumns = 5;
  constexpr int kRows = 4;
  for (int k = 0; k < kColumns * kRows; ++k) {
    const auto& lens = solution.projector.lens;
    LitPoint point{.x = {(k % kColumns + 0.5) * lens.width / kColumns, (k / kColumns + 0.5) * lens.height / kRows},
                   .q = {},
                   .cov_x = Eigen::Matrix2d::Zero(),
                   .cov_q = {}};
    const auto lands = calib::steer::land(solution, *station.station.command_rad, point.x, plane);
    bool seen = lands.has_value();
    for (std::size_t eye = 0; eye < 2 && seen; ++eye) {
      const calib::model::Device& device = solution.cameras.devices[eye];
      const auto q = device.camera.project(device.T_device_rig * lands->p);
      seen = q && q->minCoeff() > 0 && q->x() < device.camera.width - 1 && q->y() < device.camera.height - 1;
      point.q[eye] = q.value_or(Eigen::Vector2d::Zero());
      point.cov_q[eye] = kDotNoisePx * kDotNoisePx * Eigen::Matrix2d::Identity();
    }
    const auto from_eyes = seen ? eyes.see(point) : std::nullopt;
    if (from_eyes) {
      dots.push_back({.x = point.x, .p = from_eyes->p, .covariance = from_eyes->covariance});
    }
  }
  const auto refined = calib::steer::refine_look(solution, *station.station.command_rad, dots);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  if (!refined) {
    return kNone;
  }
  const auto expected = bound(rig, station, refined->state);
  return expected ? *expected : kNone;
}

Result<ClosedLoop> close_loop(const InRoom& rig, std::span<const Look> looks, std::vector<AimedStation>& stations) {
  std::vector<calib::steer::DottedLook> dotted;
  for (const Look& look : looks) {
    dotted.push_back({.command_rad = look.command_rad, .dots = dots_of(rig.solution, look)});
  }
  const auto drift = calib::steer::refine_drift(rig.solution, dotted);
  RAYSTEER_TRY(drift);
  ClosedLoop closed;
  if (sure(*drift)) {
    closed.drift = *drift;
  }
  for (AimedStation& station : stations) {
    const Eigen::Vector2d command = *station.station.command_rad;
    if (closed.drift) {
      RAYSTEER_TRY(apply(rig, drift->at(rig.solution, command), station));
    }
    if (station.within()) {
      continue;
    }
    const Look* look = look_at(looks, station);
    if (look == nullptr) {
      closed.not_looked_at.push_back(station.station.name);
      continue;
    }
    const auto& dots = dotted[static_cast<std::size_t>(look - looks.data())].dots;
    const auto refined = calib::steer::refine_look(rig.solution, command, dots);
    if (!refined) {
      return with_context(refined.error(), "look '" + look->name + "'");
    }
    station.refined = Refined{.latent_rad = refined->state.latent_rad,
                              .dots = refined->used,
                              .again_95_mm = station.worst_95_mm,
                              .stands = look == &looks.back()};
    RAYSTEER_TRY(apply(rig, refined->state, station));
  }
  return closed;
}

Result<ClosedLoop> close_loop_by(const session::Session& session, AimedRig& rig, const Tick& tick) {
  const auto gathered = gather(session, rig.room.solution.cameras, {}, tick);
  RAYSTEER_TRY(gathered);
  if (!gathered->missed.empty()) {
    return with_context(gathered->missed.front().error, "look '" + gathered->missed.front().name + "'");
  }
  return close_loop(rig.room, gathered->observations.looks, rig.aimed);
}

bool holds(const AimedStation& station) {
  return station.within() &&
         (!station.refined || station.refined->stands || station.within(station.refined->again_95_mm));
}

}  // namespace raysteer::host::rig
