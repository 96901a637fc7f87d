#include "calib/solve/start.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include "calib/solve/adjust.hpp"
#include "calib/solve/closed_form.hpp"
#include "calib/solve/solve.hpp"

namespace raysteer::calib::solve {
namespace {

constexpr std::size_t kFewestCorners = 8;  // a pose and a check on it
constexpr double kStartSigma = 0.3;        // px; only weights the robust start
constexpr double kWidestFocal = 0.2;       // of the image's width: an angle of view of 136 degrees
constexpr double kLongestFocal = 50;       // ... and of 1 degree

bool seen(const View& view, std::size_t device) {
  return device < view.corners.size() && view.corners[device].size() >= kFewestCorners;
}

Eigen::Vector2d middle_of(const DeviceInfo& device) { return {(device.width - 1) / 2.0, (device.height - 1) / 2.0}; }

std::optional<Eigen::Matrix3d> view_homography(const TargetSpec& target, const std::vector<target::Corner>& corners) {
  std::vector<Eigen::Vector2d> on_plane;
  std::vector<Eigen::Vector2d> on_image;
  for (const target::Corner& corner : corners) {
    on_plane.emplace_back(target::corner_position(target, corner.id).head<2>());
    on_image.push_back(corner.q);
  }
  return homography(on_plane, on_image);
}

Result<State> solve_one_camera(const Observations& observations, std::size_t device, model::LensModel lens) {
  const DeviceInfo& info = observations.devices[device];
  const Eigen::Vector2d centre = middle_of(info);
  std::vector<Eigen::Matrix3d> homographies;
  std::vector<int> views;
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    if (seen(observations.views[v], device)) {
      if (const auto H = view_homography(observations.target, observations.views[v].corners[device])) {
        homographies.push_back(*H);
        views.push_back(static_cast<int>(v));
      }
    }
  }
  const double width = std::max(info.width, info.height);
  const double focal =
      std::clamp(focal_length(homographies, centre).value_or(1.2 * width), kWidestFocal * width, kLongestFocal * width);
  State state;
  state.devices.push_back({.name = info.name, .kind = info.kind, .camera = {}, .T_device_rig = {}});
  model::Camera& camera = state.devices[0].camera;
  camera = {.width = info.width,
            .height = info.height,
            .fx = focal,
            .fy = focal,
            .cx = centre.x(),
            .cy = centre.y(),
            .lens = lens,
            .k = {}};
  state.T_rig_target.resize(observations.views.size());
  Measurements measurements;
  measurements.target = observations.target;
  measurements.corner_sigma_px = {kStartSigma};
  for (std::size_t i = 0; i < views.size(); ++i) {
    const auto v = static_cast<std::size_t>(views[i]);
    state.T_rig_target[v] = plane_pose(homographies[i], focal, centre);
    for (const target::Corner& corner : observations.views[v].corners[device]) {
      measurements.corners.push_back({.view = views[i], .device = 0, .id = corner.id, .q = corner.q});
    }
  }
  // A pinhole first: distortion would follow a bad start astray.
  AdjustOptions options{.robust = true, .free_distortion = {false}, .free_sag = false, .max_iterations = 30};
  if (auto report = adjust(measurements, options, state); !report) {
    return with_context(report.error(), "camera '" + info.name + "'");
  }
  options.free_distortion = {true};
  if (auto report = adjust(measurements, options, state); !report) {
    return with_context(report.error(), "camera '" + info.name + "'");
  }
  return state;
}

Result<model::Device> start_projector_linear(const Observations& observations, const State& state,
                                             std::size_t projector) {
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector2d> pixels;
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    if (seen(observations.views[v], projector)) {
      for (const target::Corner& corner : observations.views[v].corners[projector]) {
        points.push_back(state.T_rig_target[v] * target::corner_position(observations.target, corner.id));
        pixels.push_back(corner.q);
      }
    }
  }
  const auto found = resection(points, pixels);
  const DeviceInfo& info = observations.devices[projector];
  if (!found) {
    return fail(RCode::kCoplanarViews, "the projector '" + info.name + "' saw the target in one plane only");
  }
  if (found->mirrored) {
    return fail(RCode::kMirroredTarget, "camera and projector fit together only when one of their images is flipped");
  }
  model::Device device{.name = info.name, .kind = info.kind, .camera = {}, .T_device_rig = found->T_device_world};
  const double focal = std::sqrt(found->fx * found->fy);
  device.camera = {.width = info.width,
                   .height = info.height,
                   .fx = focal,
                   .fy = focal,
                   .cx = found->cx,
                   .cy = found->cy,
                   .lens = model::LensModel::kBc4,
                   .k = {}};
  return device;
}

Result<model::Device> start_projector_from(const Observations& observations, const State& state, std::size_t projector,
                                           double focal) {
  const DeviceInfo& info = observations.devices[projector];
  const Eigen::Vector2d centre = middle_of(info);
  std::vector<model::Pose> poses;
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    if (seen(observations.views[v], projector)) {
      if (const auto H = view_homography(observations.target, observations.views[v].corners[projector])) {
        poses.push_back(plane_pose(*H, focal, centre) * state.T_rig_target[v].inverse());
      }
    }
  }
  if (poses.empty()) {
    return fail(RCode::kTooFewCorrespondences, "the projector '" + info.name + "' lights the target in no view");
  }
  model::Device device{.name = info.name, .kind = info.kind, .camera = {}, .T_device_rig = median_pose(poses)};
  device.camera = {.width = info.width,
                   .height = info.height,
                   .fx = focal,
                   .fy = focal,
                   .cx = centre.x(),
                   .cy = centre.y(),
                   .lens = model::LensModel::kBc4,
                   .k = {}};
  return device;
}

}  // namespace

int Observations::projector() const {
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (devices[i].kind == model::DeviceKind::kProjector) {
      return static_cast<int>(i);
    }
  }
  return -1;
}

Status check(const Observations& observations) {
  const TargetSpec& target = observations.target;
  if (!(target.square_m > 0)) {
    return fail(RCode::kTargetScaleMissing, "square_m is " + std::to_string(target.square_m));
  }
  if (observations.devices.empty() || observations.devices[0].kind != model::DeviceKind::kCamera) {
    return fail(RCode::kCameraCount, "the first device must be a camera");
  }
  for (const View& view : observations.views) {
    for (const auto& corners : view.corners) {
      for (const target::Corner& corner : corners) {
        if (!corner.q.allFinite()) {
          return fail(RCode::kNotFinite, "view '" + view.name + "', corner " + std::to_string(corner.id));
        }
        if (corner.id < 0 || corner.id >= target.corners()) {
          return fail(RCode::kWrongTarget, "view '" + view.name + "' has a corner " + std::to_string(corner.id) +
                                               " of " + std::to_string(target.corners()));
        }
      }
    }
    for (const DecodedPixel& pixel : view.pixels) {
      if (!pixel.q.allFinite() || !pixel.x.allFinite() || !(pixel.sigma_px > 0) || !std::isfinite(pixel.sigma_px)) {
        return fail(RCode::kNotFinite, "view '" + view.name + "', a decoded pixel");
      }
    }
  }
  for (std::size_t d = 0; d < observations.devices.size(); ++d) {
    const auto count = std::ranges::count_if(observations.views, [&](const View& view) { return seen(view, d); });
    if (count < kFewestViews) {
      return fail(RCode::kTooFewViews, "'" + observations.devices[d].name + "' sees the target in " +
                                           std::to_string(count) + " views; at least " + std::to_string(kFewestViews) +
                                           " are needed, 10 or more are good");
    }
    if (d > 0) {
      const auto shared =
          std::ranges::count_if(observations.views, [&](const View& view) { return seen(view, 0) && seen(view, d); });
      if (shared < 2) {
        return fail(RCode::kTooFewViews, "'" + observations.devices[0].name + "' and '" + observations.devices[d].name +
                                             "' see the target together in " + std::to_string(shared) +
                                             " views; at least 2 are needed");
      }
    }
  }
  return ok();
}

void resolve_half_turns(Observations& observations, const std::vector<State>& alone) {
  const TargetSpec& target = observations.target;
  const bool symmetric = target.kind == TargetKind::kChessboard && target.columns % 2 == target.rows % 2;
  if (!symmetric) {
    return;
  }
  const Eigen::Vector3d far_corner = target::corner_position(target, target.corners() - 1);
  const model::Pose turned{Eigen::Quaterniond(0, 0, 0, 1), far_corner};  // half a turn about z, through the middle
  for (std::size_t d = 1; d < observations.devices.size(); ++d) {
    if (observations.devices[d].kind != model::DeviceKind::kCamera) {
      continue;
    }
    std::vector<model::Pose> both;  // each reading, upright and turned
    std::vector<std::size_t> views;
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      if (seen(observations.views[v], 0) && seen(observations.views[v], d)) {
        const model::Pose from_first = alone[0].T_rig_target[v].inverse();
        both.push_back(alone[d].T_rig_target[v] * from_first);
        both.push_back(alone[d].T_rig_target[v] * turned * from_first);
        views.push_back(v);
      }
    }
    // The right readings agree with each other; the wrong ones are spread. The pose with the nearest company is right.
    double best = std::numeric_limits<double>::infinity();
    std::size_t reference = 0;
    for (std::size_t i = 0; i < both.size(); ++i) {
      double sum = 0;
      for (std::size_t j = 0; j < both.size(); j += 2) {
        sum += std::min(both[i].q.angularDistance(both[j].q), both[i].q.angularDistance(both[j + 1].q));
      }
      if (sum < best) {
        best = sum;
        reference = i;
      }
    }
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Eigen::Quaterniond& q = both[reference].q;
      if (q.angularDistance(both[2 * i + 1].q) < q.angularDistance(both[2 * i].q)) {
        for (target::Corner& corner : observations.views[views[i]].corners[d]) {
          corner.id = target.corners() - 1 - corner.id;
        }
      }
    }
  }
}

Result<std::vector<State>> solve_alone(const Observations& observations, model::LensModel lens) {
  std::vector<State> alone;
  for (std::size_t d = 0; d < observations.devices.size(); ++d) {
    if (observations.devices[d].kind == model::DeviceKind::kProjector) {
      alone.emplace_back();
      continue;
    }
    auto state = solve_one_camera(observations, d, lens);
    if (!state) {
      return state.error();
    }
    alone.push_back(std::move(*state));
  }
  return alone;
}

double normal_spread(const Observations& observations, const std::vector<State>& alone) {
  double widest = 0;
  for (std::size_t d = 0; d < alone.size(); ++d) {
    for (std::size_t a = 0; a < alone[d].T_rig_target.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (seen(observations.views[a], d) && seen(observations.views[b], d)) {
          const Eigen::Vector3d na = alone[d].T_rig_target[a].q * Eigen::Vector3d::UnitZ();
          const Eigen::Vector3d nb = alone[d].T_rig_target[b].q * Eigen::Vector3d::UnitZ();
          widest = std::max(widest, std::acos(std::clamp(na.dot(nb), -1.0, 1.0)));
        }
      }
    }
  }
  return widest;
}

Result<State> join(const Observations& observations, const std::vector<State>& alone, double projector_start_px) {
  State state = alone[0];
  for (std::size_t d = 1; d < observations.devices.size(); ++d) {
    if (observations.devices[d].kind == model::DeviceKind::kProjector) {
      continue;
    }
    std::vector<model::Pose> poses;
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      if (seen(observations.views[v], 0) && seen(observations.views[v], d)) {
        poses.push_back(alone[d].T_rig_target[v] * alone[0].T_rig_target[v].inverse());
      }
    }
    model::Device device = alone[d].devices[0];
    device.T_device_rig = median_pose(poses);
    state.devices.push_back(device);
    for (std::size_t v = 0; v < observations.views.size(); ++v) {
      if (!seen(observations.views[v], 0) && seen(observations.views[v], d)) {
        state.T_rig_target[v] = device.T_device_rig.inverse() * alone[d].T_rig_target[v];
      }
    }
  }
  const int projector = observations.projector();
  if (projector < 0) {
    return state;
  }
  const auto p = static_cast<std::size_t>(projector);
  auto device = projector_start_px > 0 ? start_projector_from(observations, state, p, projector_start_px)
                                       : start_projector_linear(observations, state, p);
  if (!device) {
    return device.error();
  }
  state.devices.insert(state.devices.begin() + projector, *device);

  // The cameras hold still while the projector finds its place: pose, then focal length and principal point, then lens.
  Measurements measurements = collect(observations, std::vector<bool>(observations.views.size(), true));
  std::erase_if(measurements.corners, [&](const CornerMeasurement& corner) { return corner.device != projector; });
  measurements.pixels.clear();
  std::vector<bool> only(state.devices.size(), false);
  only[p] = true;
  const std::vector<bool> none(state.devices.size(), false);
  AdjustOptions options{.robust = false,
                        .free_intrinsics = none,
                        .free_distortion = none,
                        .free_pose = only,
                        .free_views = false,
                        .free_sag = false,
                        .max_iterations = 100};
  measurements.corner_sigma_px[p] = 1;
  for (const bool lens : {false, true}) {
    if (auto report = adjust(measurements, options, state); !report) {
      return with_context(report.error(), "projector '" + observations.devices[p].name + "'");
    }
    options.free_intrinsics = only;
    options.free_distortion = lens ? only : none;
  }
  if (auto report = adjust(measurements, options, state); !report) {
    return with_context(report.error(), "projector '" + observations.devices[p].name + "'");
  }
  return state;
}

Measurements collect(const Observations& observations, const std::vector<bool>& used) {
  Measurements measurements;
  measurements.target = observations.target;
  measurements.corner_sigma_px.assign(observations.devices.size(), kStartSigma);
  const int projector = observations.projector();
  for (std::size_t v = 0; v < observations.views.size(); ++v) {
    if (!used[v]) {
      continue;
    }
    const View& view = observations.views[v];
    for (std::size_t d = 0; d < observations.devices.size(); ++d) {
      if (!seen(view, d)) {
        continue;
      }
      for (const target::Corner& corner : view.corners[d]) {
        measurements.corners.push_back(
            {.view = static_cast<int>(v), .device = static_cast<int>(d), .id = corner.id, .q = corner.q});
      }
    }
    if (projector >= 0) {
      for (const DecodedPixel& pixel : view.pixels) {
        measurements.pixels.push_back({.view = static_cast<int>(v),
                                       .camera = pixel.camera,
                                       .projector = projector,
                                       .q = pixel.q,
                                       .x = pixel.x,
                                       .sigma_px = pixel.sigma_px});
      }
    }
  }
  return measurements;
}

}  // namespace raysteer::calib::solve
