#include "calib/assess/leave_out.hpp"

#include <algorithm>
#include <cmath>

#include "calib/solve/adjust.hpp"
#include "calib/solve/held_out.hpp"
#include "calib/solve/residual.hpp"
#include "calib/solve/solve.hpp"

namespace raysteer::calib::assess {
namespace {

double sorted_quantile(const std::vector<double>& sorted, double share) {
  return sorted.empty() ? 0 : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
}

// Each pose left out in turn and placed by the cameras alone: what the projector then misses.
Result<double> leave_one_out(const solve::Observations& observations, const solve::Solution& solution, int projector) {
  double squares = 0;
  int count = 0;
  for (std::size_t v = 0; v < solution.views.size(); ++v) {
    if (!solution.views[v].used) {
      continue;
    }
    std::vector<bool> others(solution.views.size(), true);
    others[v] = false;
    solve::State state = solve::state_of(solution);
    if (const auto report = adjust(kept_measurements(observations, solution, others), {}, state); !report) {
      return report.error();
    }
    std::vector<bool> only(solution.views.size(), false);
    only[v] = true;
    const solve::Measurements here = kept_measurements(observations, solution, only);
    solve::Measurements seen = here;
    seen.pixels.clear();
    std::erase_if(seen.corners, [&](const auto& corner) { return corner.device == projector; });
    const std::vector<bool> none(state.devices.size(), false);
    const solve::AdjustOptions pose_only{.free_intrinsics = none, .free_pose = none, .free_sag = false};
    if (const auto report = adjust(seen, pose_only, state); !report) {
      return report.error();
    }
    const auto p = static_cast<std::size_t>(projector);
    for (const solve::Residual& residual : solution.devices[p].residuals) {
      if (static_cast<std::size_t>(residual.view) != v || !residual.kept) {
        continue;
      }
      const solve::CornerMeasurement corner{
          .view = residual.view, .device = projector, .id = residual.id, .q = residual.q};
      Eigen::Vector2d error;
      if (corner_residual(here.target, corner, state.devices[p].camera, state.devices[p].T_device_rig,
                          state.T_rig_target[v], state.sag, error, nullptr)) {
        squares += error.squaredNorm();
        ++count;
      }
    }
  }
  return count > 0 ? std::sqrt(squares / count) : 0;
}

}  // namespace

Result<CrossValidation> cross_validate(const solve::Observations& observations, const solve::Solution& solution,
                                       int folds) {
  CrossValidation result;
  const auto used =
      static_cast<int>(std::ranges::count_if(solution.views, [](const solve::ViewFit& view) { return view.used; }));
  result.folds = std::min(folds, used);
  std::vector<double> errors;
  const auto rms = solve::held_out_error(kept_measurements(observations, solution), solve::state_of(solution),
                                         result.folds, &errors);
  if (!rms) {
    return rms.error();
  }
  std::ranges::sort(errors);
  result.corners = static_cast<int>(errors.size());
  result.rms_px = *rms;
  result.median_px = sorted_quantile(errors, 0.5);
  result.p95_px = sorted_quantile(errors, 0.95);
  if (const int projector = observations.projector(); projector >= 0) {
    const auto left_out = leave_one_out(observations, solution, projector);
    if (!left_out) {
      return left_out.error();
    }
    result.leave_one_out_px = *left_out;
  }
  return result;
}

Result<std::vector<model::Device>> half_of_the_views(const solve::Observations& observations,
                                                     const solve::Solution& solution, int which) {
  std::vector<bool> chosen(solution.views.size(), false);
  int used = 0;
  int taken = 0;
  for (std::size_t v = 0; v < chosen.size(); ++v) {
    if (solution.views[v].used) {
      chosen[v] = used++ % 2 == which;
      taken += chosen[v] ? 1 : 0;
    }
  }
  if (taken < 3) {
    return std::vector<model::Device>{};
  }
  solve::State state = solve::state_of(solution);
  if (const auto report = adjust(kept_measurements(observations, solution, chosen), {}, state); !report) {
    return report.error();
  }
  return state.devices;
}

}  // namespace raysteer::calib::assess
