// Steered rigs whose truth is known and what both eyes would see of them: noisy, but without pictures.
//
// Rays run through sim/optics, which is written apart from calib/model, so that a shared mistake cannot hide.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calib/steer/drawing.hpp"
#include "calib/steer/observations.hpp"
#include "hal/base/noise.hpp"
#include "host/rig/drawing.hpp"
#include "proto/board/board.hpp"
#include "sim/optics/light_path.hpp"
#include "sim/rig/truth.hpp"

namespace raysteer::support {

struct IdealOptions {
  double noise_px = 0.2;  ///< one standard deviation of each coordinate: left, right and panel
  double repeatability_rad = 20e-6;
  int points = 300;            ///< per look; fewer where the light leaves the pictures
  bool relief = true;          ///< boxes up to 0.9 m on the floor, otherwise the bare floor
  double box_height = 1;       ///< share of the boxes' height
  bool drawn_cameras = false;  ///< cameras known only as drawn; else as calibrated with a board
  bool known_ends = false;     ///< drawn cameras: the known length lies between two places on the floor, not the eyes
};

/// What the camera calibration is off by, one standard deviation each; it is stated as the cameras' covariance.
struct CameraErrors {
  double focal = 2e-4;  ///< relative
  double centre_px = 0.2;
  double k1 = 5e-4;
  double k2 = 5e-4;
  double tangential = 2e-5;
  double rotation_rad = 50e-6;
  double baseline = 1e-4;  ///< of its length, along it and across it
};

inline constexpr double kFloorDepth = 3.5;  ///< metres below the left camera, across its axis

/// The board file's drawing as a solve starts from it; the boards of tests can be drawn.
inline calib::steer::Drawing drawing_of(const proto::board::Board& board) {
  return host::rig::drawing_of(board).value();
}

struct IdealRig {
  sim::rig::Truth truth;
  calib::model::SteeredProjector projector;  ///< the truth as our model says it
  calib::model::Rig cameras;                 ///< the truth; covariance zero
};

namespace ideal {

inline calib::model::Camera lens_of(const sim::optics::Lens& lens, int width, int height) {
  const auto& n = lens.numbers();
  return {.width = width,
          .height = height,
          .fx = n.focal_px.x(),
          .fy = n.focal_px.y(),
          .cx = n.centre_px.x(),
          .cy = n.centre_px.y(),
          .k = {n.distortion[0], n.distortion[1], n.distortion[2], n.distortion[3]}};
}

inline calib::model::Pose pose_of(const Eigen::Isometry3d& T) {
  return {Eigen::Quaterniond(T.linear()).normalized(), T.translation()};
}

inline Eigen::Vector2d normals(Noise& noise, double sigma) {
  const double x = noise.normal();
  const double y = noise.normal();
  return sigma * Eigen::Vector2d(x, y);
}

struct Box {
  Eigen::Vector3d least, most;
};

/// About half of the floor within reach under boxes.
inline std::vector<Box> boxes(std::uint64_t seed, double share = 1) {
  Noise noise(seed, 0xb0);
  std::vector<Box> boxes;
  for (int k = 0; k < 60; ++k) {
    const double x = noise.uniform(-3, 3);
    const double y = noise.uniform(-2, 2);
    const double width = noise.uniform(0.2, 0.7);
    const double length = noise.uniform(0.2, 0.7);
    const double height = share * noise.uniform(0.05, 0.9);
    boxes.push_back({{x, y, kFloorDepth - height}, {x + width, y + length, kFloorDepth}});
  }
  return boxes;
}

/// Where a ray first meets the floor or a box.
inline std::optional<Eigen::Vector3d> meet(const Eigen::Vector3d& from, const Eigen::Vector3d& along,
                                           std::span<const Box> boxes) {
  if (!(along.z() > 0.05)) {
    return std::nullopt;
  }
  double nearest = (kFloorDepth - from.z()) / along.z();
  for (const Box& box : boxes) {
    const Eigen::Array3d a = (box.least - from).array() / along.array();
    const Eigen::Array3d b = (box.most - from).array() / along.array();
    const double in = a.min(b).maxCoeff();
    if (in > 0 && in < a.max(b).minCoeff()) {
      nearest = std::min(nearest, in);
    }
  }
  return from + nearest * along;
}

}  // namespace ideal

/// A rig drawn as its board's tolerances say. Errors: those of sim::rig::draw_truth().
inline Result<IdealRig> draw_ideal(const proto::board::Board& board, std::uint64_t seed) {
  auto truth = sim::rig::draw_truth(board, seed);
  if (!truth) {
    return std::move(truth).error();
  }
  IdealRig rig{.truth = *std::move(truth), .projector = drawing_of(board).projector, .cameras = {}};
  const sim::optics::TrueRig& t = rig.truth.rig;
  calib::model::SteeredProjector& p = rig.projector;
  p.lens = ideal::lens_of(t.projector.lens, t.projector.width, t.projector.height);
  p.T_projector_rig = ideal::pose_of(t.projector.T_projector_rig);
  for (std::size_t k = 0; k < 2; ++k) {
    p.parts[k].axis = t.mirror.parts[k].axis;
    p.parts[k].point = t.mirror.parts[k].point;
    p.parts[k].normal = t.mirror.parts[k].normal;
    p.parts[k].offset_m = t.mirror.parts[k].offset_m;
    const hal::mock::CommandCurve& c = rig.truth.curves[k];
    p.curves[k] = {c.half_range, c.gain, c.quadratic, c.cubic, c.cross_talk};
  }
  p.outer_axis = t.mirror.outer_axis;
  p.outer_point = t.mirror.outer_point;
  int count = 0;
  for (const sim::optics::TrueCamera& camera : t.cameras) {
    rig.cameras.devices.push_back({.name = camera.name,
                                   .kind = calib::model::DeviceKind::kCamera,
                                   .camera = ideal::lens_of(camera.lens, camera.width, camera.height),
                                   .T_device_rig = ideal::pose_of(camera.T_camera_rig)});
    count += rig.cameras.count(rig.cameras.devices.size() - 1);
  }
  rig.cameras.covariance = Eigen::MatrixXd::Zero(count, count);
  return rig;
}

/// The cameras as a calibration would have found them: off by `errors`, which their covariance states.
inline calib::model::Rig calibrated_cameras(const IdealRig& rig, std::uint64_t seed, const CameraErrors& errors = {}) {
  Noise noise(seed, 0xca);
  calib::model::Rig cameras = rig.cameras;
  int first = 0;
  for (std::size_t i = 0; i < cameras.devices.size(); ++i) {
    calib::model::Device& device = cameras.devices[i];
    const int count = cameras.count(i);
    Eigen::VectorXd sigma = Eigen::VectorXd::Zero(count);
    sigma.head<8>() << errors.focal * device.camera.fx, errors.focal * device.camera.fy, errors.centre_px,
        errors.centre_px, errors.k1, errors.k2, errors.tangential, errors.tangential;
    if (i > 0) {
      sigma.tail<6>() << Eigen::Vector3d::Constant(errors.rotation_rad),
          Eigen::Vector3d::Constant(errors.baseline * device.T_device_rig.t.norm());
    }
    Eigen::VectorXd delta(count);
    for (int k = 0; k < count; ++k) {
      delta[k] = sigma[k] * noise.normal();
    }
    device = calib::model::perturbed(device, delta, i > 0);
    cameras.covariance.diagonal().segment(first, count) = sigma.cwiseAbs2();
    first += count;
  }
  return cameras;
}

/// What both eyes see of a look at each command. The scene and the camera calibration come from `seed` alone, so that
/// other looks at the same rig see the same world with the same cameras. `stream` draws other noise.
inline calib::steer::Observations observe(const IdealRig& rig, std::span<const Eigen::Vector2d> commands,
                                          const IdealOptions& options, std::uint64_t seed,
                                          std::vector<Eigen::Vector2d>* true_latents = nullptr,
                                          std::uint64_t stream = 0) {
  calib::steer::Observations observations{.cameras = calibrated_cameras(rig, seed), .looks = {}};
  const std::vector<ideal::Box> boxes =
      options.relief ? ideal::boxes(seed, options.box_height) : std::vector<ideal::Box>();
  const sim::optics::TrueRig& t = rig.truth.rig;
  const double stated = std::max(options.noise_px, 0.01);
  const Eigen::Matrix2d covariance = stated * stated * Eigen::Matrix2d::Identity();
  if (true_latents != nullptr) {
    true_latents->clear();
  }
  for (std::size_t k = 0; k < commands.size(); ++k) {
    Noise noise(seed, 0x100c, stream, k);
    const Eigen::Vector2d latent = ideal::normals(noise, options.repeatability_rad);
    const Eigen::Vector2d angles = rig.projector.angles(commands[k]) + latent;
    const sim::optics::LightPath path(t, {Radians(angles.x()), Radians(angles.y())});
    calib::steer::Look look{.name = "look-" + std::to_string(k + 1),
                            .command_rad = commands[k],
                            .feedback_rad = commands[k] + ideal::normals(noise, 5e-6),
                            .points = {}};
    for (int attempt = 0; attempt < 4 * options.points && static_cast<int>(look.points.size()) < options.points;
         ++attempt) {
      const double i = noise.uniform(-0.5, t.projector.width - 0.5);
      const double j = noise.uniform(-0.5, t.projector.height - 0.5);
      const Eigen::Vector2d x(i, j);
      const auto out = path.leave(x);
      const auto p = out && out->passage.through ? ideal::meet(out->origin, out->direction, boxes) : std::nullopt;
      if (!p) {
        continue;
      }
      calib::steer::LitPoint point{.x = x + ideal::normals(noise, options.noise_px),
                                   .q = {},
                                   .cov_x = covariance,
                                   .cov_q = {covariance, covariance}};
      bool seen = true;
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const sim::optics::TrueCamera& camera = t.cameras[eye];
        const Eigen::Vector3d to = *p - camera.centre();
        const auto again = ideal::meet(camera.centre(), to, boxes);
        const auto q = camera.project(*p);
        seen = seen && q && again && (*again - *p).norm() < 1e-6 && q->x() > 0 && q->y() > 0 &&
               q->x() < camera.width - 1 && q->y() < camera.height - 1;
        point.q[eye] = q.value_or(Eigen::Vector2d::Zero()) + ideal::normals(noise, options.noise_px);
      }
      if (seen) {
        look.points.push_back(point);
      }
    }
    observations.looks.push_back(std::move(look));
    if (true_latents != nullptr) {
      true_latents->push_back(latent);
    }
  }
  return observations;
}

/// `columns` x `rows` commands over `share` of the allowed range, from one corner row by row.
inline std::vector<Eigen::Vector2d> command_grid(const calib::model::SteeredProjector& projector, int columns, int rows,
                                                 double share = 0.95) {
  std::vector<Eigen::Vector2d> commands;
  const Eigen::Vector2d middle = (projector.most_rad + projector.least_rad) / 2;
  const Eigen::Vector2d half = share * (projector.most_rad - projector.least_rad) / 2;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double u = columns > 1 ? 2.0 * i / (columns - 1) - 1 : 0;
      const double v = rows > 1 ? 2.0 * j / (rows - 1) - 1 : 0;
      commands.emplace_back(middle + Eigen::Vector2d(u * half.x(), v * half.y()));
    }
  }
  return commands;
}

}  // namespace raysteer::support
