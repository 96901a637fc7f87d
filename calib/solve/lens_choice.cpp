#include "calib/solve/lens_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/solve/adjust.hpp"
#include "calib/solve/residual.hpp"
#include "calib/solve/start.hpp"

namespace raysteer::calib::solve {
namespace {

constexpr int kFolds = 4;
constexpr double kBetter = 0.99;      // BC5 against BC4: one more number must earn itself
constexpr double kMuchBetter = 0.90;  // BC8 (algorithms 1.2)

// Every second corner of the target, like the black squares of a chessboard.
bool places_the_view(const TargetSpec& target, const CornerMeasurement& corner) {
  return (corner.id % target.corner_columns() + corner.id / target.corner_columns()) % 2 == 0;
}

}  // namespace

Result<double> held_out_error(const Measurements& measurements, const State& start, int folds,
                              std::vector<double>* errors) {
  // Views that have corners, dealt to the folds in turn.
  std::vector<int> fold(start.T_rig_target.size(), -1);
  int next = 0;
  for (std::size_t v = 0; v < fold.size(); ++v) {
    const bool seen = std::ranges::any_of(measurements.corners, [&](const CornerMeasurement& corner) {
      return static_cast<std::size_t>(corner.view) == v;
    });
    if (seen) {
      fold[v] = next++ % folds;
    }
  }
  double squares = 0;
  int count = 0;
  for (int f = 0; f < std::min(folds, next); ++f) {
    Measurements training = measurements;
    std::erase_if(training.corners,
                  [&](const CornerMeasurement& corner) { return fold[static_cast<std::size_t>(corner.view)] == f; });
    std::erase_if(training.pixels,
                  [&](const PixelMeasurement& pixel) { return fold[static_cast<std::size_t>(pixel.view)] == f; });
    State state = start;
    if (const auto report = adjust(training, {.max_iterations = 30}, state); !report) {
      return report.error();
    }
    Measurements placing = measurements;
    placing.pixels.clear();
    std::erase_if(placing.corners, [&](const CornerMeasurement& corner) {
      return fold[static_cast<std::size_t>(corner.view)] != f || !places_the_view(measurements.target, corner);
    });
    const std::vector<bool> none(state.devices.size(), false);
    const AdjustOptions pose_only{.free_intrinsics = none, .free_pose = none, .free_sag = false, .max_iterations = 20};
    if (const auto report = adjust(placing, pose_only, state); !report) {
      return report.error();
    }
    for (const CornerMeasurement& corner : measurements.corners) {
      if (fold[static_cast<std::size_t>(corner.view)] != f || places_the_view(measurements.target, corner)) {
        continue;
      }
      const auto d = static_cast<std::size_t>(corner.device);
      Eigen::Vector2d error;
      if (!corner_residual(measurements.target, corner, state.devices[d].camera, state.devices[d].T_device_rig,
                           state.T_rig_target[static_cast<std::size_t>(corner.view)], state.sag, error, nullptr)) {
        return fail(RCode::kSolverDiverged, "a held-out corner lies behind its camera");
      }
      squares += error.squaredNorm();
      ++count;
      if (errors != nullptr) {
        errors->push_back(error.norm());
      }
    }
  }
  if (count == 0) {
    return fail(RCode::kTooFewViews, "no corners were left to test with");
  }
  return std::sqrt(squares / count);
}

Status choose_lens(const Observations& observations, std::size_t device, State& alone, std::vector<LensTrial>& trials) {
  Measurements measurements = collect(observations, std::vector<bool>(observations.views.size(), true));
  measurements.pixels.clear();
  std::erase_if(measurements.corners,
                [&](const CornerMeasurement& corner) { return corner.device != static_cast<int>(device); });
  for (CornerMeasurement& corner : measurements.corners) {
    corner.device = 0;
  }
  // Mistaken corners would drown the differences between lens models: those beyond 4 sigma of the start stay out.
  std::vector<double> lengths;
  const auto length = [&](const CornerMeasurement& corner) {
    Eigen::Vector2d error;
    const bool seen =
        corner_residual(measurements.target, corner, alone.devices[0].camera, {},
                        alone.T_rig_target[static_cast<std::size_t>(corner.view)], alone.sag, error, nullptr);
    return seen ? error.norm() : std::numeric_limits<double>::infinity();
  };
  for (const CornerMeasurement& corner : measurements.corners) {
    lengths.push_back(length(corner));
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::ranges::nth_element(lengths, middle);
  const double limit = 4 * std::max(0.05, *middle / 1.17741);
  std::erase_if(measurements.corners, [&](const CornerMeasurement& corner) { return length(corner) > limit; });

  std::size_t chosen = trials.size();
  const std::size_t first = trials.size();
  std::vector<State> states;
  for (const model::LensModel lens : {model::LensModel::kBc4, model::LensModel::kBc5, model::LensModel::kBc8}) {
    State state = alone;
    state.devices[0].camera.lens = lens;
    for (int i = coefficients(lens); i < 8; ++i) {
      state.devices[0].camera.k[static_cast<std::size_t>(i)] = 0;
    }
    LensTrial trial{.device = observations.devices[device].name,
                    .lens = lens,
                    .held_out_px = std::numeric_limits<double>::infinity(),
                    .monotonic = false,
                    .chosen = false};
    if (adjust(measurements, {.max_iterations = 30}, state)) {
      trial.monotonic = state.devices[0].camera.is_monotonic();
      if (const auto error = held_out_error(measurements, state, kFolds)) {
        trial.held_out_px = *error;
      }
    }
    trials.push_back(trial);
    states.push_back(state);
    const std::size_t here = trials.size() - 1;
    const double factor = lens == model::LensModel::kBc8 ? kMuchBetter : kBetter;
    const bool usable = trial.monotonic && std::isfinite(trial.held_out_px);
    if (usable && (!trials[chosen < here ? chosen : here].monotonic || chosen == here ||
                   trial.held_out_px < factor * trials[chosen].held_out_px)) {
      chosen = here;
    }
  }
  if (!trials[chosen].monotonic || !std::isfinite(trials[chosen].held_out_px)) {
    return fail(RCode::kSolverDiverged, "no lens model fits camera '" + observations.devices[device].name + "'");
  }
  trials[chosen].chosen = true;
  alone = states[chosen - first];
  return ok();
}

}  // namespace raysteer::calib::solve
