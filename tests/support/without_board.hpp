// Statistics over many ideal rigs that were calibrated without any board: cameras start as drawn.
#pragma once

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/steer_trial.hpp"

namespace raysteer::support {

struct WithoutBoardOptions {
  int rigs = 100;
  IdealOptions observed{.points = 60, .relief = true, .drawn_cameras = true};
  int unseen_looks = 10;
  int threads = 1;
};

struct WithoutBoard {
  int solved = 0;
  std::map<std::string, int> refused;    ///< by code
  std::vector<std::uint64_t> bad_seeds;  ///< of refused ones
  std::vector<double> camera_focal;      ///< of each camera, relative, absolute value
  std::vector<double> projector_focal;   ///< of each rig
  std::vector<double> focal_normalised;  ///< of each camera: error over its stated sigma
  std::vector<double> scale;             ///< of each rig: distance between the eyes, relative
  std::vector<double> scale_normalised;  ///< of each rig: its error over its stated sigma
  std::vector<double> length;            ///< of each rig: a length on the floor as the solved cameras see it, relative
  std::vector<double> length_normalised;
  Misses unseen;

  int refusals(const std::string& code) const {
    const auto found = refused.find(code);
    return found == refused.end() ? 0 : found->second;
  }
  int refusals() const {
    int sum = 0;
    for (const auto& [code, count] : refused) {
      sum += count;
    }
    return sum;
  }
};

/// Rig i has seed + i, whatever the number of threads. A length is known to half a millimetre (IdealOptions).
inline WithoutBoard many_without_board(const PlannedBoard& board, std::uint64_t seed,
                                       const WithoutBoardOptions& options) {
  std::vector<WithoutBoard> all(static_cast<std::size_t>(options.rigs));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      const SteerTrial trial(board, seed + i, options.observed);
      WithoutBoard& one = all[i];
      if (!trial.solution()) {
        one.refused[to_string(trial.solution().error().rcode)] = 1;
        one.bad_seeds = {seed + i};
        continue;
      }
      one.solved = 1;
      const calib::steer::Solution& solution = *trial.solution();
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const double f = solution.cameras.devices[eye].camera.fx;
        const double error = f / trial.rig().cameras.devices[eye].camera.fx - 1;
        const int at = solution.cameras.offset(eye);
        one.camera_focal.push_back(std::abs(error));
        one.focal_normalised.push_back(error * f / std::sqrt(solution.covariance(at, at)));
      }
      one.projector_focal = {std::abs(solution.projector.lens.fx / trial.rig().projector.lens.fx - 1)};
      const Eigen::Vector3d& t = solution.cameras.devices[1].T_device_rig.t;
      const double scale_error = t.norm() / trial.rig().cameras.devices[1].T_device_rig.t.norm() - 1;
      const Eigen::Matrix3d of_t = solution.cameras.covariance.bottomRightCorner<3, 3>();
      one.scale = {std::abs(scale_error)};
      one.scale_normalised = {scale_error * t.squaredNorm() / std::sqrt(t.dot(of_t * t))};
      const SteerTrial::LengthMiss miss = trial.length_miss();
      one.length = {std::abs(miss.relative)};
      one.length_normalised = {miss.sigmas};
      one.unseen = trial.unseen(options.unseen_looks);
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 1; i < options.threads; ++i) {
      threads.emplace_back(work);
    }
    work();
  }
  WithoutBoard many;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (const WithoutBoard& one : all) {
    many.solved += one.solved;
    for (const auto& [code, count] : one.refused) {
      many.refused[code] += count;
    }
    append(many.bad_seeds, one.bad_seeds);
    append(many.camera_focal, one.camera_focal);
    append(many.projector_focal, one.projector_focal);
    append(many.focal_normalised, one.focal_normalised);
    append(many.scale, one.scale);
    append(many.scale_normalised, one.scale_normalised);
    append(many.length, one.length);
    append(many.length_normalised, one.length_normalised);
    many.unseen.add(one.unseen);
  }
  return many;
}

}  // namespace raysteer::support
