#include "calib/solve/lens_choice.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/solve/adjust.hpp"
#include "calib/solve/held_out.hpp"
#include "calib/solve/residual.hpp"
#include "calib/solve/start.hpp"

namespace raysteer::calib::solve {
namespace {

constexpr int kFolds = 4;
constexpr std::size_t kEnoughCorners = 1500;
constexpr double kBetter = 0.97;      // BC5 against BC4: one more number must earn itself
constexpr double kMuchBetter = 0.90;  // BC8 (algorithms 1.2)

}  // namespace

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

  // A part of them tells as much and takes a part of the time: every n-th, n odd so that both colours stay.
  const std::size_t stride = (measurements.corners.size() / kEnoughCorners) | 1;
  std::size_t index = 0;
  std::erase_if(measurements.corners, [&](const CornerMeasurement&) { return index++ % stride != 0; });

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
