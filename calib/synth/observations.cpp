#include "calib/synth/observations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace raysteer::calib::synth {
namespace {

using model::Camera;
using model::Device;
using model::DeviceKind;
using model::Pose;

Eigen::Vector3d middle(const TargetSpec& target) {
  return 0.5 * target.square_m * Eigen::Vector3d(target.corner_columns() - 1, target.corner_rows() - 1, 0);
}

bool inside(const Camera& camera, const Eigen::Vector2d& q, double margin) {
  return q.x() >= margin && q.y() >= margin && q.x() <= camera.width - 1 - margin &&
         q.y() <= camera.height - 1 - margin;
}

bool seen_whole(const Device& device, const TargetSpec& target, const Pose& T_rig_target, double margin) {
  const Pose T_device_target = device.T_device_rig * T_rig_target;
  for (int id = 0; id < target.corners(); ++id) {
    const auto q = device.camera.project(T_device_target * target::corner_position(target, id));
    if (!q || !inside(device.camera, *q, margin)) {
      return false;
    }
  }
  return true;
}

/// Where the ray of a pixel meets the target's plane, in the target's frame.
std::optional<Eigen::Vector3d> on_target(const Device& device, const Pose& T_rig_target, const Eigen::Vector2d& q) {
  const auto n = device.camera.normalize(q);
  if (!n) {
    return std::nullopt;
  }
  const Pose T_target_device = (device.T_device_rig * T_rig_target).inverse();
  const Eigen::Vector3d direction = T_target_device.q * n->homogeneous();
  const double s = -T_target_device.t.z() / direction.z();
  return s > 0 ? std::optional<Eigen::Vector3d>(T_target_device.t + s * direction) : std::nullopt;
}

}  // namespace

std::vector<Pose> target_poses(const model::Rig& rig, const TargetSpec& target, const TargetPlan& plan,
                               std::uint64_t seed) {
  constexpr double kDistances[] = {0.8, 1.0, 1.25};
  constexpr int kTries = 200;
  const Device& first = rig.devices.front();
  Noise noise(seed, 0x7a67);
  std::vector<Pose> poses;
  for (int view = 0; view < plan.views; ++view) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      // Later tries stay nearer to the middle, so that a plan that is too bold still ends.
      const double spread = 1.0 - 0.8 * attempt / kTries;
      const Eigen::Vector2d q(first.camera.width * (0.5 + spread * noise.uniform(-0.5, 0.5)),
                              first.camera.height * (0.5 + spread * noise.uniform(-0.5, 0.5)));
      const double distance = plan.distance_m * kDistances[view % 3] * noise.uniform(0.95, 1.05);
      const double tilt = plan.tilt_rad * (view % 3 == 2 ? noise.uniform(0, 0.3) : noise.uniform(0.5, 1));
      const double heading = 2 * std::numbers::pi * noise.uniform();
      const double roll = noise.uniform(-0.3, 0.3);
      const auto n = first.camera.normalize(q);
      if (!n) {
        continue;
      }
      Pose T_camera_target;
      T_camera_target.q = Eigen::AngleAxisd(tilt, Eigen::Vector3d(std::cos(heading), std::sin(heading), 0)) *
                          Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ());
      T_camera_target.t = distance * n->homogeneous().normalized() - T_camera_target.q * middle(target);
      const Pose T_rig_target = first.T_device_rig.inverse() * T_camera_target;
      const bool good = std::all_of(rig.devices.begin(), rig.devices.end(), [&](const Device& device) {
        return (device.kind == DeviceKind::kProjector && !plan.on_panel) ||
               seen_whole(device, target, T_rig_target, plan.margin_px);
      });
      if (good) {
        poses.push_back(T_rig_target);
        break;
      }
    }
  }
  return poses;
}

TargetView observe(const model::Rig& rig, const TargetSpec& target, const Pose& T_rig_target,
                   const MeasurementNoise& sigma, Noise& noise, int panel_pixels) {
  TargetView view{T_rig_target, std::vector<std::vector<target::Corner>>(rig.devices.size()), {}};
  const Device* projector = nullptr;
  for (std::size_t i = 0; i < rig.devices.size(); ++i) {
    const Device& device = rig.devices[i];
    if (device.kind == DeviceKind::kProjector) {
      projector = &device;
      continue;
    }
    const Pose T_device_target = device.T_device_rig * T_rig_target;
    for (int id = 0; id < target.corners(); ++id) {
      const auto q = device.camera.project(T_device_target * target::corner_position(target, id));
      if (q && inside(device.camera, *q, 0)) {
        const Eigen::Vector2d error(noise.normal(), noise.normal());
        view.corners[i].push_back({id, *q + sigma.corner_px * error, sigma.corner_px});
      }
    }
  }
  if (projector == nullptr) {
    return view;
  }

  const Device& camera = rig.devices.front();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const target::Corner& corner : view.corners.front()) {
    low = low.cwiseMin(corner.q);
    high = high.cwiseMax(corner.q);
  }
  const Eigen::Vector3d far_corner = 2 * middle(target);
  const double step = std::max(1.0, std::floor(std::sqrt((high - low).prod() / std::max(panel_pixels, 1))));
  for (double y = std::ceil(low.y()); y <= high.y(); y += step) {
    for (double x = std::ceil(low.x()); x <= high.x(); x += step) {
      const auto place = on_target(camera, T_rig_target, {x, y});
      if (!place || place->x() < 0 || place->y() < 0 || place->x() > far_corner.x() || place->y() > far_corner.y()) {
        continue;
      }
      const auto panel = projector->camera.project(projector->T_device_rig * (T_rig_target * *place));
      if (panel && inside(projector->camera, *panel, 0)) {
        const Eigen::Vector2d error(noise.normal(), noise.normal());
        view.pixels.push_back({0, {x, y}, *panel + sigma.panel_px * error, sigma.panel_px});
      }
    }
  }
  return view;
}

}  // namespace raysteer::calib::synth
