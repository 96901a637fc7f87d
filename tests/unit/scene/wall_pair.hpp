// A camera pair 1 m before a wall with a wave in it, and what it sees of a projector's pixels.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"
#include "calib/synth/noise.hpp"

namespace raysteer::calib::scene {

struct WallPair {
  model::Rig rig;
  std::vector<Match> matches;
  std::vector<Eigen::Vector3d> truth;  ///< of each match, rig frame
};

/// A right camera 0.1 m to the right, toed in a little; both with some distortion.
inline model::Rig pair_rig() {
  model::Camera camera{.width = 1200, .height = 900, .fx = 1500, .fy = 1500, .cx = 600, .cy = 450};
  camera.lens = model::LensModel::kBc5;
  camera.k = {-0.08, 0.05, 0.0005, -0.0003, 0.0};
  model::Rig rig;
  rig.devices = {{"left", model::DeviceKind::kCamera, camera, {}}, {"right", model::DeviceKind::kCamera, camera, {}}};
  rig.devices[1].T_device_rig.q =
      Eigen::Quaterniond(Eigen::AngleAxisd(0.08, Eigen::Vector3d(0.05, -1, 0.03).normalized()));
  rig.devices[1].T_device_rig.t = Eigen::Vector3d(-0.1, 0.002, 0.004);
  return rig;
}

/// Matches of `columns` x `rows` projector pixels spread over the view; each coordinate with noise of `sigma_px`.
inline WallPair wall_pair(const model::Rig& rig, int columns, int rows, double sigma_px, std::uint64_t seed) {
  WallPair pair{rig, {}, {}};
  synth::Noise noise(seed);
  const TwoViews views = *two_views(rig, 0, 1);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double x = -0.35 + 0.7 * (i + 0.5) / columns;
      const double y = -0.25 + 0.5 * (j + 0.5) / rows;
      const Eigen::Vector3d p(x, y, 1 + 0.1 * x + 0.06 * std::sin(9 * x) * std::cos(7 * y));
      const auto left = views.left.project(p);
      const auto right = views.right.project(views.T_right_left * p);
      if (!left || !right) {
        continue;
      }
      Match match;
      match.i = static_cast<std::uint16_t>(i);
      match.j = static_cast<std::uint16_t>(j);
      match.q_left = *left + sigma_px * Eigen::Vector2d(noise.normal(), noise.normal());
      match.q_right = *right + sigma_px * Eigen::Vector2d(noise.normal(), noise.normal());
      match.cov_left = match.cov_right = sigma_px * sigma_px * Eigen::Matrix2d::Identity();
      pair.matches.push_back(match);
      pair.truth.push_back(p);
    }
  }
  return pair;
}

/// The same rig with its right camera turned by `turn` (rad, right camera's axes).
inline model::Rig turned(model::Rig rig, const Eigen::Vector3d& turn) {
  rig.devices[1].T_device_rig.q =
      Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * rig.devices[1].T_device_rig.q;
  return rig;
}

}  // namespace raysteer::calib::scene
