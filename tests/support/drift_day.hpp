// A day unattended: mirrors warm up, the room's temperature swings, and a few dots now and then are all there is.
#pragma once

#include <algorithm>
#include <vector>

#include "hal/mock/mirror_parameters.hpp"
#include "hal/mock/room.hpp"
#include "tests/support/steer_trial.hpp"

namespace raysteer::support {

struct DriftDay {
  double hours = 8;
  double every_s = 300;  ///< between dots
  hal::mock::Room room{.trend_k_per_h = 0, .swing_k = 5, .cycle_s = 8 * 3600};
  hal::mock::WarmUp warm_up{.time_constant_s = 600, .on_before_s = 0};  ///< calibrated cold
  int looks = 4;                                                        ///< with dots, each time
  int dots = 5;                                                         ///< per look
  int remembered = 2;                                                   ///< times whose dots count
};

struct DriftMisses {
  Misses corrected;
  Misses open_loop;
};

/// What hal/mock's mirror of the board's preset is off by at `t_s`, since time 0.
inline Eigen::Vector2d thermal(const hal::mock::MirrorParameters& mirror, const DriftDay& day, double t_s,
                               const Eigen::Vector2d& angles) {
  const double warm = day.warm_up.since_start(t_s);
  const double kelvin = day.room.kelvin(t_s);
  Eigen::Vector2d off;
  for (int i = 0; i < 2; ++i) {
    const hal::mock::AxisErrors& e = mirror.axes[static_cast<std::size_t>(i)].errors;
    off[i] = e.warm_offset * warm + e.room_offset * kelvin + (e.warm_gain * warm + e.room_gain * kelvin) * angles[i];
  }
  return off;
}

/// Errors just before the next dots, when the correction is oldest: one random look each time.
inline DriftMisses drift_misses(const SteerTrial& trial, const DriftDay& day = {}) {
  const auto mirror = hal::mock::mirror_preset(trial.board().drawn.board.mirror.preset);
  if (!mirror) {
    throw std::runtime_error(mirror.error().message());
  }
  DriftMisses misses;
  Noise noise(trial.seed(), 0xd4);
  const auto stands = [&](const Eigen::Vector2d& command, double t_s) {
    const Eigen::Vector2d angles = trial.rig().projector.angles(command);
    return Eigen::Vector2d(angles + thermal(*mirror, day, t_s, angles) +
                           ideal::normals(noise, trial.options().repeatability_rad));
  };
  // Dots stand at corners of a box within the range, as far apart as gains need.
  const Eigen::Vector2d middle = (trial.board().least_rad + trial.board().most_rad) / 2;
  const Eigen::Vector2d half = 0.7 * (trial.board().most_rad - trial.board().least_rad) / 2;
  std::vector<calib::steer::DottedLook> seen;
  for (double t = 0; t < day.hours * 3600; t += day.every_s) {
    for (int k = 0; k < day.looks; ++k) {
      const Eigen::Vector2d command =
          middle + Eigen::Vector2d(k % 2 == 0 ? -half.x() : half.x(), (k + k / 2) % 2 == 0 ? -half.y() : half.y());
      seen.push_back({command, trial.dots(stands(command, t), day.dots, noise)});
    }
    const auto keep = static_cast<std::ptrdiff_t>(day.looks * day.remembered);
    if (static_cast<std::ptrdiff_t>(seen.size()) > keep) {
      seen.erase(seen.begin(), seen.end() - keep);
    }
    const auto drift = calib::steer::refine_drift(*trial.solution(), seen);
    const Eigen::Vector2d command = trial.random_command(noise);
    const Eigen::Vector2d angles = stands(command, t + day.every_s);
    trial.measure(command, angles, {}, noise, misses.open_loop);
    trial.measure(command, angles, drift ? drift->at(*trial.solution(), command) : calib::steer::LookState{}, noise,
                  misses.corrected);
  }
  return misses;
}

}  // namespace raysteer::support
