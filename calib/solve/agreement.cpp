#include "calib/solve/agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

#include "calib/solve/adjust.hpp"
#include "calib/solve/residual.hpp"
#include "calib/solve/solve.hpp"
#include "calib/solve/start.hpp"

namespace raysteer::calib::solve {
namespace {

// A view is odd when its corners miss by this many times what the better half of the views miss, and by this much.
constexpr double kOddRatio = 4;
constexpr double kOddLeast = 0.5;  // px
constexpr double kMostOdd = 0.25;  // of the views; with more, it is not the views that are odd

std::string px(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f px", value);
  return text.data();
}

double median_of(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, at);
  return *at;
}

Measurements corners_of(const Observations& observations, const std::vector<bool>& used) {
  Measurements measurements = collect(observations, used);
  measurements.pixels.clear();
  return measurements;
}

// Median two-dimensional error per view; 0 for views that are not used.
std::vector<double> view_errors(const Measurements& measurements, const State& state) {
  std::vector<std::vector<double>> lengths(state.T_rig_target.size());
  for (const CornerMeasurement& corner : measurements.corners) {
    const auto d = static_cast<std::size_t>(corner.device);
    const auto v = static_cast<std::size_t>(corner.view);
    Eigen::Vector2d error;
    const bool seen = corner_residual(measurements.target, corner, state.devices[d].camera,
                                      state.devices[d].T_device_rig, state.T_rig_target[v], state.sag, error, nullptr);
    lengths[v].push_back(seen ? error.norm() : 1e6);
  }
  std::vector<double> errors;
  for (auto& length : lengths) {
    errors.push_back(length.empty() ? 0 : median_of(std::move(length)));
  }
  return errors;
}

double typical(const std::vector<double>& errors) {
  std::vector<double> used;
  std::ranges::copy_if(errors, std::back_inserter(used), [](double error) { return error > 0; });
  if (used.empty()) {
    return 0;
  }
  std::ranges::sort(used);
  return used[(used.size() - 1) / 3];  // of the better ones: up to a half may be spoilt
}

// Where do the devices stand otherwise before and after? Fits each half by itself, lenses held; a real nudge leaves
// both halves as good as single cameras are.
struct Split {
  std::size_t first_after = 0;
  double cost = std::numeric_limits<double>::infinity();
  double turned_rad = 0;
  double shifted_m = 0;
};

std::optional<double> fit_range(const Observations& observations, const std::vector<bool>& used, State& state) {
  Measurements measurements = corners_of(observations, used);
  AdjustOptions options{.robust = true,
                        .free_intrinsics = std::vector<bool>(state.devices.size(), false),
                        .free_sag = false,
                        .max_iterations = 20};
  const auto report = adjust(measurements, options, state);
  return report ? std::optional<double>(report->cost) : std::nullopt;
}

Split best_split(const Observations& observations, const State& state) {
  const std::size_t count = observations.views.size();
  Split best;
  for (std::size_t k = 2; k + 2 <= count; ++k) {
    std::vector<bool> before(count, false);
    std::vector<bool> after(count, true);
    for (std::size_t v = 0; v < k; ++v) {
      before[v] = true;
      after[v] = false;
    }
    State early = state;
    State late = state;
    const auto cost_early = fit_range(observations, before, early);
    const auto cost_late = fit_range(observations, after, late);
    if (!cost_early || !cost_late || *cost_early + *cost_late >= best.cost) {
      continue;
    }
    best = {.first_after = k, .cost = *cost_early + *cost_late, .turned_rad = 0, .shifted_m = 0};
    for (std::size_t d = 1; d < state.devices.size(); ++d) {
      const model::Pose& a = early.devices[d].T_device_rig;
      const model::Pose& b = late.devices[d].T_device_rig;
      best.turned_rad = std::max(best.turned_rad, a.q.angularDistance(b.q));
      best.shifted_m = std::max(best.shifted_m, (a.inverse().t - b.inverse().t).norm());
    }
  }
  return best;
}

// Half a chi-square of what is robustly left when every device stands for itself: the best that any explanation
// reaches.
double cost_alone(const Observations& observations, const std::vector<State>& alone) {
  double cost = 0;
  for (std::size_t d = 0; d < observations.devices.size(); ++d) {
    if (alone[d].devices.empty()) {
      continue;
    }
    Measurements measurements = corners_of(observations, std::vector<bool>(observations.views.size(), true));
    std::erase_if(measurements.corners,
                  [&](const CornerMeasurement& corner) { return corner.device != static_cast<int>(d); });
    for (CornerMeasurement& corner : measurements.corners) {
      corner.device = 0;
    }
    State state = alone[d];
    const AdjustOptions options{.robust = true, .free_intrinsics = {false}, .free_sag = false, .max_iterations = 10};
    if (const auto report = adjust(measurements, options, state)) {
      cost += report->cost;
    }
  }
  return cost;
}

}  // namespace

Status leave_out_disagreeing_views(const Observations& observations, const std::vector<State>& alone, State& state,
                                   std::vector<ViewFit>& views) {
  const std::size_t count = views.size();
  const State start = state;
  std::vector<bool> used;
  for (const ViewFit& view : views) {
    used.push_back(view.used);
  }
  const auto most = static_cast<std::size_t>(std::max(1.0, kMostOdd * static_cast<double>(count)));
  std::size_t odd = 0;
  for (;;) {
    Measurements measurements = corners_of(observations, used);
    if (const auto report = adjust(measurements, {.robust = true, .max_iterations = 30}, state); !report) {
      return report.error();
    }
    const std::vector<double> errors = view_errors(measurements, state);
    const double limit = std::max(kOddLeast, kOddRatio * typical(errors));
    const auto worst = std::ranges::max_element(errors);
    if (*worst <= limit) {
      break;
    }
    const auto v = static_cast<std::size_t>(worst - errors.begin());
    if (++odd > most) {
      break;
    }
    used[v] = false;
    views[v].used = false;
    views[v].why = RCode::kForeignView;
    views[v].why_note =
        "its corners miss the calibration of the others by " + px(*worst) + " (they: " + px(typical(errors)) + ")";
  }
  if (odd > most) {
    const bool several = observations.devices.size() > 1;
    const Split split = several && count >= 4 ? best_split(observations, start) : Split{};
    // Both halves good: within twice what the devices reach alone (a nudge missed by one view stays far above).
    if (several && split.cost < 2 * cost_alone(observations, alone) + 1) {
      std::array<char, 160> moved{};
      std::snprintf(moved.data(), moved.size(), "; the devices turned by %.2f mrad and shifted by %.2f mm",
                    1e3 * split.turned_rad, 1e3 * split.shifted_m);
      return fail(RCode::kCameraMovedDuringCapture,
                  "between view '" + views[split.first_after - 1].name + "' and view '" +
                      views[split.first_after].name + "'" + moved.data(),
                  static_cast<std::int64_t>(split.first_after));
    }
    std::string names;
    for (const ViewFit& view : views) {
      if (!view.used) {
        names += (names.empty() ? "'" : ", '") + view.name + "'";
      }
    }
    return fail(RCode::kForeignView, "more than " + std::to_string(most) + " of " + std::to_string(count) +
                                         " views disagree, the worst are " + names);
  }
  if (const auto left = std::ranges::count(used, true); left < kFewestViews) {
    return fail(RCode::kTooFewViews, std::to_string(left) + " views agree with each other; at least " +
                                         std::to_string(kFewestViews) + " are needed");
  }
  return ok();
}

}  // namespace raysteer::calib::solve
