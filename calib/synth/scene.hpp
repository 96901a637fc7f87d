// value: a world made of plates and balls, and the devices that look at it: the truth that tests compare with.
//
// Everything is in the rig's frame (metres), the frame of model::Rig.
#pragma once

#include <Eigen/Dense>
#include <memory>
#include <optional>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"
#include "calib/synth/print.hpp"

namespace raysteer::calib::synth {

/// A flat rectangle [u0, u1] x [v0, v1] in the plane z = 0 of its own frame; matte, both sides alike. Its print, if
/// any, is seen from the side of negative z, as a target is held: x right, y down, z away from the camera.
struct Plate {
  model::Pose T_rig_plate;
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  double albedo = 0.7;  ///< where there is no print
  std::shared_ptr<const Print> print;
};

struct Ball {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double radius = 0;
  double albedo = 0.7;
};

struct Scene {
  std::vector<Plate> plates;
  std::vector<Ball> balls;
};

/// A plate `width` x `height` about the origin of its frame.
Plate plate(const model::Pose& T_rig_plate, double width, double height, double albedo);

/// A printed target with a white margin of `margin_m` around its squares.
Plate target_plate(const model::Pose& T_rig_target, std::shared_ptr<const Print> print, double margin_m);

/// Adds the six faces of a box of size (x, y, z) about the origin of its frame.
void add_box(Scene& scene, const model::Pose& T_rig_box, const Eigen::Vector3d& size, double albedo);

/// The nearest surface along origin + s * direction, s > 0.
struct Hit {
  double s = 0;                                      ///< in lengths of `direction`
  Eigen::Vector3d p = Eigen::Vector3d::Zero();       ///< rig frame
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit length, towards the origin of the ray
  int surface = -1;                                  ///< plates first, then balls
  double u = 0, v = 0;                               ///< place on a plate
  bool front = false;                                ///< a plate's printed side
};
std::optional<Hit> first_hit(const Scene& scene, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction);

/// Does anything stand between the two points?
bool blocked(const Scene& scene, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Distance from a point to the nearest surface, metres; infinite for an empty scene.
double distance_to(const Scene& scene, const Eigen::Vector3d& p);

}  // namespace raysteer::calib::synth
