// A look whose truth is known: two cameras above a floor, a projector that lights it, perhaps by way of a mirror.
#pragma once

#include <Eigen/Dense>
#include <random>
#include <vector>

#include "calib/look/solve_look.hpp"

namespace raysteer::support {

struct PretendLook {
  calib::look::Input input;     ///< what the devices measured
  calib::look::Solution truth;  ///< T_rig_plane and panel
};

/// A pose that looks from `eye` at `at`, x to the right as seen with `up` up.
inline calib::model::Pose looking(const Eigen::Vector3d& eye, const Eigen::Vector3d& at, const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = (at - eye).normalized();
  const Eigen::Vector3d x = z.cross(up).normalized();
  Eigen::Matrix3d R;
  R << x.transpose(), z.cross(x).transpose(), z.transpose();
  return {Eigen::Quaterniond(R), -R * eye};
}

/// The truth alone: `input` has everything but corners and discs. Panel 640x400, cameras 640x512.
inline PretendLook pretend_look(std::mt19937_64& random, bool mirrored) {
  std::uniform_real_distribution<double> some(-1, 1);
  PretendLook look;
  // The plane's frame is the world: board at the origin, x right, y down, z away, so "above" is -z.
  const auto near = [&](double x, double y, double z) {
    return Eigen::Vector3d(x + 0.1 * some(random), y + 0.1 * some(random), z + 0.1 * some(random));
  };
  const Eigen::Vector3d middle(0.45, 0.1, 0);
  const calib::model::Pose T_left_plane = looking(near(0.2, 1.2, -1.6), middle, Eigen::Vector3d(0, -1, -1));
  const calib::model::Pose T_right_plane = looking(near(0.6, 1.2, -1.6), middle, Eigen::Vector3d(0, -1, -1));
  look.truth.T_rig_plane = T_left_plane;
  for (const auto& T_camera_plane : {T_left_plane, T_right_plane}) {
    calib::model::Camera camera{.width = 640, .height = 512, .fx = 800 + 20 * some(random), .cx = 318, .cy = 258};
    camera.fy = camera.fx;
    camera.k = {-0.05 * some(random), 0.02, 1e-4, -1e-4};
    look.input.sights.push_back({camera, T_camera_plane * T_left_plane.inverse(), {}, {}});
  }
  calib::model::Camera drawing{.width = 640, .height = 400, .fx = 900, .fy = 900, .cx = 319.5, .cy = 420};
  look.input.drawing = drawing;
  calib::model::Camera lens = drawing;
  lens.fx = lens.fy = 900 * (1 + 0.01 * some(random));
  lens.cx += 6 * some(random);
  lens.cy += 6 * some(random);
  lens.k = {0.02 * some(random), 0.01 * some(random), 5e-4 * some(random), 5e-4 * some(random)};
  look.truth.panel.mirrored = mirrored;
  look.truth.panel.lens = mirrored ? calib::model::flipped(lens) : lens;
  look.truth.panel.T_projector_plane =
      looking(near(0.4, -0.5, -1.5), middle + Eigen::Vector3d(0, -0.25, 0), Eigen::Vector3d(0.2, -1, 0));
  look.input.grid = calib::target::fill_panel(640, 400, 9);
  look.input.target.columns = 9;
  look.input.target.rows = 6;
  look.input.target.square_m = 0.025;
  return look;
}

/// Where a camera truly sees a place on the plane.
inline std::optional<Eigen::Vector2d> seen(const PretendLook& look, std::size_t eye, const Eigen::Vector2d& p) {
  const calib::look::Sight& sight = look.input.sights[eye];
  return sight.camera.project(sight.T_camera_rig * (look.truth.T_rig_plane * Eigen::Vector3d(p.x(), p.y(), 0)));
}

}  // namespace raysteer::support
