// Known rigs and what they would have measured: for tests and campaigns of the solvers.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/solve/observations.hpp"
#include "calib/solve/solution.hpp"
#include "calib/synth/noise.hpp"
#include "calib/synth/observations.hpp"

namespace raysteer::support {

enum class Devices { kMono, kStereo, kProjector };

struct SolverCase {
  calib::model::Rig truth;
  calib::solve::Observations observations;
};

inline TargetSpec solver_target() {
  TargetSpec target;
  target.columns = 9;
  target.rows = 6;
  target.square_m = 0.04;
  return target;
}

inline calib::model::Rig solver_rig(Devices devices, std::uint64_t seed) {
  using calib::model::Camera;
  using calib::model::DeviceKind;
  calib::synth::Noise noise(seed, 77);
  calib::model::Rig rig;
  Camera camera{.width = 1280, .height = 960, .fx = 1400, .fy = 1402, .cx = 646, .cy = 471};
  camera.k = {-0.08, 0.05, 0.0004, -0.0003, 0, 0, 0, 0};
  rig.devices.push_back({.name = "left", .kind = DeviceKind::kCamera, .camera = camera, .T_device_rig = {}});
  if (devices == Devices::kStereo) {
    camera.fx = 1390;
    camera.fy = 1388;
    camera.cx = 631;
    camera.k = {-0.07, 0.03, -0.0002, 0.0004, 0, 0, 0, 0};
    rig.devices.push_back({.name = "right", .kind = DeviceKind::kCamera, .camera = camera, .T_device_rig = {}});
    rig.devices[1].T_device_rig.q =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d(0.05, 1, 0.1).normalized()));
    rig.devices[1].T_device_rig.t = {-0.15, 0.004, 0.01};
  }
  if (devices == Devices::kProjector) {
    // Shifted lens: the principal point lies below the panel. Pixels are square to 0.2 %, as the solver believes.
    Camera panel{.width = 1024, .height = 768, .fx = 1300, .fy = 1300, .cx = 505, .cy = 830};
    panel.fy = 1300 * (1 + 0.002 * noise.normal());
    panel.k = {-0.06, 0.04, 0.0003, -0.0002, 0, 0, 0, 0};
    rig.devices.push_back({.name = "projector", .kind = DeviceKind::kProjector, .camera = panel, .T_device_rig = {}});
    rig.devices[1].T_device_rig.q =
        Eigen::Quaterniond(Eigen::AngleAxisd(0.33, Eigen::Vector3d(1, 0.1, 0).normalized()));
    rig.devices[1].T_device_rig.t = {0.05, 0.15, 0.05};
  }
  return rig;
}

inline SolverCase solver_case(Devices devices, std::uint64_t seed, int views = 12, double sigma_px = 0.1) {
  SolverCase result{.truth = solver_rig(devices, seed), .observations = {}};
  calib::solve::Observations& observations = result.observations;
  observations.target = solver_target();
  for (const calib::model::Device& device : result.truth.devices) {
    observations.devices.push_back({device.name, device.kind, device.camera.width, device.camera.height});
  }
  const bool projector = devices == Devices::kProjector;
  const calib::synth::TargetPlan plan{.views = views, .distance_m = 0.8, .tilt_rad = 0.6, .on_panel = projector};
  const auto poses = calib::synth::target_poses(result.truth, observations.target, plan, seed);
  calib::synth::Noise noise(seed, 5);
  for (std::size_t v = 0; v < poses.size(); ++v) {
    const auto seen = calib::synth::observe(result.truth, observations.target, poses[v],
                                            {.corner_px = sigma_px, .panel_px = sigma_px}, noise, 120);
    calib::solve::View view{.name = "view" + std::to_string(v), .corners = seen.corners, .pixels = {}};
    view.corners.resize(result.truth.devices.size());
    if (projector) {
      // Corners on the panel are what a local fit would give: the truth with little noise of its own.
      const calib::model::Device& device = result.truth.devices[1];
      for (int id = 0; id < observations.target.corners(); ++id) {
        const Eigen::Vector3d p =
            device.T_device_rig * (poses[v] * calib::target::corner_position(observations.target, id));
        if (const auto x = device.camera.project(p)) {
          view.corners[1].push_back({id, *x + 0.02 * Eigen::Vector2d(noise.normal(), noise.normal()), 0.02});
        }
      }
      for (const auto& pixel : seen.pixels) {
        view.pixels.push_back({.camera = pixel.camera, .q = pixel.q, .x = pixel.x, .sigma_px = pixel.sigma_px});
      }
    }
    observations.views.push_back(std::move(view));
  }
  return result;
}

/// Parameters of `truth` minus those of the solution, in the order of the covariance; rotations as left increments.
inline Eigen::VectorXd parameter_error(const calib::solve::Solution& solution, const calib::model::Rig& truth) {
  Eigen::VectorXd error(solution.rig.covariance.rows());
  for (std::size_t d = 0; d < truth.devices.size(); ++d) {
    const auto& device = solution.rig.devices[d];
    Eigen::VectorXd difference = parameters(truth.devices[d], d > 0) - parameters(device, d > 0);
    if (d > 0) {
      const Eigen::AngleAxisd turn(truth.devices[d].T_device_rig.q * device.T_device_rig.q.conjugate());
      difference.segment<3>(difference.size() - 6) = turn.angle() * turn.axis();
    }
    error.segment(solution.rig.offset(d), solution.rig.count(d)) = difference;
  }
  return error;
}

/// Normalised error squared: chi-square with as many degrees of freedom as there are parameters, if sigma is honest.
inline double normalised_error_squared(const calib::solve::Solution& solution, const calib::model::Rig& truth) {
  const Eigen::VectorXd error = parameter_error(solution, truth);
  const Eigen::VectorXd scale = solution.rig.covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd unit = scale.asDiagonal() * solution.rig.covariance * scale.asDiagonal();
  const Eigen::VectorXd scaled = scale.asDiagonal() * error;
  return scaled.dot(unit.ldlt().solve(scaled));
}

/// Quantile of chi-square by Wilson and Hilferty: z standard deviations of the cube root.
inline double chi_square_quantile(double freedom, double z) {
  const double a = 2.0 / (9.0 * freedom);
  return freedom * std::pow(1 - a + z * std::sqrt(a), 3);
}
/// Two-sided 99.99 %.
constexpr double kSigma9999 = 3.8906;

}  // namespace raysteer::support
