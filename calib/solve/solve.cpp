#include "calib/solve/solve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/solve/adjust.hpp"
#include "calib/solve/agreement.hpp"
#include "calib/solve/lens_choice.hpp"
#include "calib/solve/residual.hpp"
#include "calib/solve/start.hpp"

namespace raysteer::calib::solve {
namespace {

constexpr double kGate = 4;                                // sigma (algorithms 1.3)
constexpr double kLeastTilt = 5 * 3.14159265358979 / 180;  // radians between the most different normals

struct Flags {
  std::vector<bool> corners;
  std::vector<bool> pixels;
};

Eigen::Vector2d error_of(const Measurements& all, const CornerMeasurement& corner, const State& state) {
  const auto d = static_cast<std::size_t>(corner.device);
  Eigen::Vector2d error;
  if (!corner_residual(all.target, corner, state.devices[d].camera, state.devices[d].T_device_rig,
                       state.T_rig_target[static_cast<std::size_t>(corner.view)], state.sag, error, nullptr)) {
    error.setConstant(1e6);
  }
  return error;
}

Eigen::Vector2d error_of(const Measurements& all, const PixelMeasurement& pixel, const State& state) {
  const model::Device& camera = state.devices[static_cast<std::size_t>(pixel.camera)];
  const model::Device& projector = state.devices[static_cast<std::size_t>(pixel.projector)];
  Eigen::Vector2d error;
  if (!pixel_residual(all.target, pixel, camera.camera, camera.T_device_rig, projector.camera, projector.T_device_rig,
                      state.T_rig_target[static_cast<std::size_t>(pixel.view)], state.sag, error, nullptr)) {
    error.setConstant(1e6);
  }
  return error;
}

double median_of(std::vector<double>& values) {
  if (values.empty()) {
    return 0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, at);
  return *at;
}

// Per coordinate from the median length of two-dimensional errors (Rayleigh: median = sigma sqrt(2 ln 2)).
double robust_sigma(std::vector<double>& lengths) { return median_of(lengths) / 1.17741; }

Measurements keep(const Measurements& all, const Flags& flags) {
  Measurements kept = all;
  kept.corners.clear();
  kept.pixels.clear();
  for (std::size_t i = 0; i < all.corners.size(); ++i) {
    if (flags.corners[i]) {
      kept.corners.push_back(all.corners[i]);
    }
  }
  for (std::size_t i = 0; i < all.pixels.size(); ++i) {
    if (flags.pixels[i]) {
      kept.pixels.push_back(all.pixels[i]);
    }
  }
  return kept;
}

// Decoded pixels and the panel coordinates of corners come from the same light: with pixels, the projector's corners
// only start the solve, decide which views agree, and are reported. Counting them again would make sigma too small.
Measurements without_double_counting(Measurements measurements) {
  if (!measurements.pixels.empty()) {
    const int projector = measurements.pixels.front().projector;
    std::erase_if(measurements.corners, [&](const CornerMeasurement& corner) { return corner.device == projector; });
  }
  return measurements;
}

int unknowns(const State& state, const Measurements& measurements) {
  int count = 2;
  for (std::size_t d = 0; d < state.devices.size(); ++d) {
    count += 4 + coefficients(state.devices[d].camera.lens) + (d > 0 ? 6 : 0);
  }
  std::vector<bool> views(state.T_rig_target.size(), false);
  for (const CornerMeasurement& corner : measurements.corners) {
    views[static_cast<std::size_t>(corner.view)] = true;
  }
  return count + 6 * static_cast<int>(std::ranges::count(views, true));
}

// Robust sigma per device and of pixels from the errors of everything.
void measure_robustly(const State& state, Measurements& all) {
  for (std::size_t d = 0; d < state.devices.size(); ++d) {
    std::vector<double> lengths;
    for (const CornerMeasurement& corner : all.corners) {
      if (static_cast<std::size_t>(corner.device) == d) {
        lengths.push_back(error_of(all, corner, state).norm());
      }
    }
    all.corner_sigma_px[d] = std::max(kSigmaFloor, robust_sigma(lengths));
  }
}

// Sigma from the squares of what was kept, with the degrees of freedom the unknowns took.
void measure_plainly(const State& state, const Measurements& kept, Measurements& all) {
  const Measurements adjusted = without_double_counting(kept);
  const double numbers = 2.0 * static_cast<double>(adjusted.corners.size() + adjusted.pixels.size());
  const double freedom = std::max(0.1, 1 - unknowns(state, kept) / numbers);
  for (std::size_t d = 0; d < state.devices.size(); ++d) {
    double squares = 0;
    double count = 0;
    for (const CornerMeasurement& corner : kept.corners) {
      if (static_cast<std::size_t>(corner.device) == d) {
        squares += error_of(kept, corner, state).squaredNorm();
        count += 2;
      }
    }
    if (count > 0) {
      all.corner_sigma_px[d] = std::max(kSigmaFloor, std::sqrt(squares / count / freedom));
    }
  }
  double ratios = 0;
  for (const PixelMeasurement& pixel : kept.pixels) {
    ratios += error_of(kept, pixel, state).squaredNorm() / (pixel.sigma_px * pixel.sigma_px);
  }
  if (!kept.pixels.empty()) {
    all.pixel_scale = std::sqrt(ratios / (2 * static_cast<double>(kept.pixels.size())) / freedom);
  }
}

// Every corner of the views used, all of equal weight and none left out: the number that other tools give.
double plain_fit(const Measurements& all, State state) {
  Measurements corners = all;
  corners.pixels.clear();
  std::ranges::fill(corners.corner_sigma_px, 1);
  if (!adjust(corners, {}, state)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  double squares = 0;
  for (const CornerMeasurement& corner : corners.corners) {
    squares += error_of(corners, corner, state).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(corners.corners.size()));
}

// Pixels carry the sigma they were decoded with; how far they really miss is one factor for all.
void measure_pixel_scale(const State& state, Measurements& all) {
  std::vector<double> ratios;
  for (const PixelMeasurement& pixel : all.pixels) {
    ratios.push_back(error_of(all, pixel, state).norm() / pixel.sigma_px);
  }
  all.pixel_scale = ratios.empty() ? 1 : robust_sigma(ratios);
}

Flags within_gate(const Measurements& all, const State& state) {
  Flags flags;
  for (const CornerMeasurement& corner : all.corners) {
    flags.corners.push_back(error_of(all, corner, state).norm() <=
                            kGate * all.corner_sigma_px[static_cast<std::size_t>(corner.device)]);
  }
  for (const PixelMeasurement& pixel : all.pixels) {
    flags.pixels.push_back(error_of(all, pixel, state).norm() <= kGate * pixel_sigma(all, pixel));
  }
  return flags;
}

double tilt_of(const model::Pose& pose) {
  const Eigen::Vector3d normal = pose.q * Eigen::Vector3d::UnitZ();
  return std::acos(std::min(1.0, std::abs(normal.z())));
}

std::vector<std::string> parameter_names(const std::vector<model::Device>& devices) {
  static constexpr std::array kNames{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
  static constexpr std::array kPose{"rx", "ry", "rz", "tx", "ty", "tz"};
  std::vector<std::string> names;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    for (int i = 0; i < 4 + coefficients(devices[d].camera.lens); ++i) {
      names.push_back(devices[d].name + "." + kNames[static_cast<std::size_t>(i)]);
    }
    for (std::size_t i = 0; d > 0 && i < kPose.size(); ++i) {
      names.push_back(devices[d].name + "." + kPose[i]);
    }
  }
  return names;
}

// Residuals of everything, kept or not, and their summaries.
void fill_residuals(const Observations& observations, const Measurements& all, const Flags& flags, const State& state,
                    Solution& solution) {
  solution.devices.resize(state.devices.size());
  std::vector<std::vector<double>> squares(observations.views.size(), std::vector<double>(state.devices.size(), 0));
  std::vector<std::vector<int>> counts(observations.views.size(), std::vector<int>(state.devices.size(), 0));
  double all_squares = 0;
  double every_squares = 0;
  double whitened = 0;  // of what was adjusted
  int whitened_count = 0;
  int all_count = 0;
  for (std::size_t d = 0; d < state.devices.size(); ++d) {
    DeviceFit& fit = solution.devices[d];
    fit.name = state.devices[d].name;
    fit.sigma_px = all.corner_sigma_px[d];
    double sum = 0;
    for (std::size_t i = 0; i < all.corners.size(); ++i) {
      const CornerMeasurement& corner = all.corners[i];
      if (static_cast<std::size_t>(corner.device) != d) {
        continue;
      }
      const Eigen::Vector2d error = error_of(all, corner, state);
      fit.residuals.push_back(
          {.view = corner.view, .id = corner.id, .q = corner.q, .error = error, .kept = flags.corners[i]});
      ++fit.corners_seen;
      every_squares += error.squaredNorm();
      if (flags.corners[i]) {
        ++fit.corners_kept;
        sum += error.squaredNorm();
        if (all.pixels.empty() || state.devices[d].kind == model::DeviceKind::kCamera) {
          whitened += error.squaredNorm() / (fit.sigma_px * fit.sigma_px);
          whitened_count += 2;
        }
        squares[static_cast<std::size_t>(corner.view)][d] += error.squaredNorm();
        ++counts[static_cast<std::size_t>(corner.view)][d];
      }
    }
    all_squares += sum;
    all_count += fit.corners_kept;
    fit.rms_px = fit.corners_kept > 0 ? std::sqrt(sum / fit.corners_kept) : 0;
  }
  solution.all_corners_rms_px =
      all.corners.empty() ? 0 : std::sqrt(every_squares / static_cast<double>(all.corners.size()));
  solution.rms_px = all_count > 0 ? std::sqrt(all_squares / all_count) : 0;

  double pixel_squares = 0;
  int pixel_count = 0;
  for (std::size_t i = 0; i < all.pixels.size(); ++i) {
    const PixelMeasurement& pixel = all.pixels[i];
    const Eigen::Vector2d error = error_of(all, pixel, state);
    solution.pixels.push_back(
        {.view = pixel.view, .q = pixel.q, .x = pixel.x, .error = error, .kept = flags.pixels[i]});
    if (flags.pixels[i]) {
      pixel_squares += error.squaredNorm();
      const double sigma = pixel_sigma(all, pixel);
      whitened += error.squaredNorm() / (sigma * sigma);
      whitened_count += 2;
      ++pixel_count;
    }
  }
  solution.pixel_rms_px = pixel_count > 0 ? std::sqrt(pixel_squares / pixel_count) : 0;
  solution.whitened_rms = std::sqrt(whitened / std::max(1, whitened_count));

  const Eigen::Vector3d middle = target::corner_position(observations.target, observations.target.corners() - 1) / 2;
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    ViewFit& view = solution.views[v];
    view.T_rig_target = state.T_rig_target[v];
    view.tilt_rad = tilt_of(view.T_rig_target);
    view.distance_m = (view.T_rig_target * middle).norm();
    for (std::size_t d = 0; d < state.devices.size(); ++d) {
      view.rms_px.push_back(counts[v][d] > 0 ? std::sqrt(squares[v][d] / counts[v][d]) : 0);
    }
  }
}

}  // namespace

Result<Solution> solve(const Observations& given, const SolveOptions& options) {
  const auto tell = [&](std::string_view stage, double done) {
    if (options.progress) {
      options.progress(stage, done);
    }
  };
  Observations observations = given;
  RAYSTEER_TRY(check(observations));
  tell("starting", 0);
  auto alone = solve_alone(observations, options.lens.value_or(model::LensModel::kBc5));
  if (!alone) {
    return alone.error();
  }
  if (const double spread = normal_spread(observations, *alone); spread < kLeastTilt) {
    return fail(RCode::kCoplanarViews, "the target's tilt changes by only " +
                                           std::to_string(spread * 180 / 3.14159265358979) +
                                           " degrees over all views; at least 20 are good");
  }
  resolve_half_turns(observations, *alone);

  Solution solution;
  tell("choosing the lens model", 0.2);
  for (std::size_t d = 0; d < observations.devices.size(); ++d) {
    if (observations.devices[d].kind == model::DeviceKind::kCamera && !options.lens) {
      RAYSTEER_TRY(choose_lens(observations, d, (*alone)[d], solution.lenses));
    }
  }

  tell("joining the devices", 0.5);
  auto joined = join(observations, *alone, options.projector_start_px);
  if (!joined) {
    return joined.error();
  }
  State state = std::move(*joined);
  for (const View& view : observations.views) {
    solution.views.push_back({.name = view.name,
                              .used = true,
                              .why = RCode::kNone,
                              .why_note = {},
                              .T_rig_target = {},
                              .rms_px = {},
                              .tilt_rad = 0,
                              .distance_m = 0});
  }
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    if (std::ranges::all_of(observations.views[v].corners, &std::vector<target::Corner>::empty)) {
      solution.views[v].used = false;
      solution.views[v].why = RCode::kTargetNotFound;
      solution.views[v].why_note = "no device saw the target";
    }
  }
  // Corners decide which views agree; pixels join afterwards.
  RAYSTEER_TRY(leave_out_disagreeing_views(observations, *alone, state, solution.views));

  tell("adjusting", 0.7);
  std::vector<bool> used;
  for (const ViewFit& view : solution.views) {
    used.push_back(view.used);
  }
  Measurements all = collect(observations, used);
  measure_robustly(state, all);
  measure_pixel_scale(state, all);
  if (auto report = adjust(without_double_counting(all), {.robust = true}, state); !report) {
    return report.error();
  }
  measure_robustly(state, all);
  measure_pixel_scale(state, all);
  Flags flags = within_gate(all, state);
  // Twice: the sigma of the kept ones is a better gate than the first, robust one.
  for (int round = 0; round < 2; ++round) {
    const Measurements kept = keep(all, flags);
    const auto report = adjust(without_double_counting(kept), {}, state);
    if (!report) {
      return report.error();
    }
    solution.iterations = report->iterations;
    measure_plainly(state, kept, all);
    if (round == 0) {
      flags = within_gate(all, state);
    }
  }
  for (const model::Device& device : state.devices) {
    if (!device.camera.is_monotonic()) {
      return fail(RCode::kSolverDiverged, "the lens of '" + device.name +
                                              "' folds its image: its distortion is not "
                                              "determined by these views");
    }
  }

  const auto sigma = covariance(without_double_counting(keep(all, flags)), state);
  if (!sigma) {
    return sigma.error();
  }
  const auto shared = sigma->shared.rows();
  solution.rig.devices = state.devices;
  solution.rig.parameters = parameter_names(state.devices);
  solution.rig.covariance = sigma->shared.topLeftCorner(shared - 2, shared - 2);
  solution.sag_m = state.sag;
  solution.pixel_scale = all.pixel_scale;
  solution.plain_fit_rms_px = plain_fit(all, state);
  solution.sag_sigma_m = sigma->shared.diagonal().tail<2>().cwiseSqrt();
  fill_residuals(observations, all, flags, state, solution);
  tell("adjusting", 1);
  return solution;
}

State state_of(const Solution& solution) {
  State state;
  state.devices = solution.rig.devices;
  state.sag = solution.sag_m;
  for (const ViewFit& view : solution.views) {
    state.T_rig_target.push_back(view.T_rig_target);
  }
  return state;
}

Measurements kept_measurements(const Observations& observations, const Solution& solution,
                               const std::vector<bool>& views) {
  const auto wanted = [&](int view) {
    const auto v = static_cast<std::size_t>(view);
    return solution.views[v].used && (views.empty() || views[v]);
  };
  Measurements kept;
  kept.target = observations.target;
  for (std::size_t d = 0; d < solution.devices.size(); ++d) {
    kept.corner_sigma_px.push_back(solution.devices[d].sigma_px);
    for (const Residual& residual : solution.devices[d].residuals) {
      if (residual.kept && wanted(residual.view)) {
        kept.corners.push_back(
            {.view = residual.view, .device = static_cast<int>(d), .id = residual.id, .q = residual.q});
      }
    }
  }
  const int projector = observations.projector();
  std::size_t next = 0;
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    for (const DecodedPixel& pixel : observations.views[v].pixels) {
      if (!solution.views[v].used) {
        continue;
      }
      if (solution.pixels[next].kept && wanted(static_cast<int>(v))) {
        kept.pixels.push_back({.view = static_cast<int>(v),
                               .camera = pixel.camera,
                               .projector = projector,
                               .q = pixel.q,
                               .x = pixel.x,
                               .sigma_px = pixel.sigma_px});
      }
      ++next;
    }
  }
  kept.pixel_scale = solution.pixel_scale;
  return without_double_counting(std::move(kept));
}

}  // namespace raysteer::calib::solve
