// Statistics over many ideal rigs of one board: each is drawn, observed, solved from the drawing and judged by its
// truth.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <thread>
#include <vector>

#include "tests/support/drift_day.hpp"
#include "tests/support/floor_task.hpp"
#include "tests/support/steer_trial.hpp"

namespace raysteer::support {

struct ManyOptions {
  int rigs = 100;
  IdealOptions observed{.points = 45};
  calib::steer::Options solver;
  int unseen_looks = 10;
  int closed_loop_looks = 0;
  bool floor_task = false;
  bool drift = false;
  int threads = 1;
};

struct ManyRigs {
  int solved = 0;
  int wrong = 0;                         ///< accepted, and yet off by four times what the plan promised, in the median
  std::map<std::string, int> refused;    ///< by code
  std::vector<std::uint64_t> bad_seeds;  ///< of refused and wrong ones
  std::vector<double> whitened_rms;
  std::vector<double> median_px;  ///< of each rig
  Misses unseen;
  Misses closed_loop;
  FloorErrors floor;
  DriftMisses drift;

  int refusals() const {
    int sum = 0;
    for (const auto& [code, count] : refused) {
      sum += count;
    }
    return sum;
  }
};

/// Rig i has seed + i, whatever the number of threads.
inline ManyRigs many_rigs(const PlannedBoard& board, std::uint64_t seed, const ManyOptions& options) {
  struct One {
    std::string refused;
    double whitened_rms = 0;
    Misses unseen, closed_loop;
    FloorErrors floor;
    DriftMisses drift;
  };
  std::vector<One> all(static_cast<std::size_t>(options.rigs));
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < all.size(); i = next++) {
      const SteerTrial trial(board, seed + i, options.observed, options.solver);
      One& one = all[i];
      if (!trial.solution()) {
        one.refused = to_string(trial.solution().error().rcode);
        continue;
      }
      one.whitened_rms = trial.solution()->whitened_rms;
      one.unseen = trial.unseen(options.unseen_looks);
      one.closed_loop = trial.closed_loop(options.closed_loop_looks);
      one.floor = options.floor_task ? floor_errors(trial) : FloorErrors{};
      one.drift = options.drift ? drift_misses(trial) : DriftMisses{};
    }
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 1; i < options.threads; ++i) {
      threads.emplace_back(work);
    }
    work();
  }
  ManyRigs many;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const One& one = all[i];
    if (!one.refused.empty()) {
      ++many.refused[one.refused];
      many.bad_seeds.push_back(seed + i);
      continue;
    }
    ++many.solved;
    many.whitened_rms.push_back(one.whitened_rms);
    many.median_px.push_back(quantile(one.unseen.px, 0.5));
    if (many.median_px.back() > 4 * board.prediction.unseen_px) {
      ++many.wrong;
      many.bad_seeds.push_back(seed + i);
    }
    many.unseen.add(one.unseen);
    many.closed_loop.add(one.closed_loop);
    many.floor.add(one.floor);
    many.drift.corrected.add(one.drift.corrected);
    many.drift.open_loop.add(one.drift.open_loop);
  }
  return many;
}

}  // namespace raysteer::support
