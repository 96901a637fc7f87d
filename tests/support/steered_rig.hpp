// pure: rigs for tests of what is baked: the same optics once for calib/model and once, written apart, for sim/optics.
#pragma once

#include <Eigen/Geometry>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>

#include "calib/bake/station.hpp"
#include "calib/model/steered_projector.hpp"
#include "proto/board/board.hpp"
#include "sim/optics/light_path.hpp"
#include "sim/optics/true_rig.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::support {

struct SteeredRig {
  sim::optics::TrueRig truth;
  calib::model::SteeredProjector projector;

  sim::optics::LightPath path(const Eigen::Vector2d& command_rad) const {
    const Eigen::Vector2d angles = projector.angles(command_rad);
    return {truth, {Radians(angles.x()), Radians(angles.y())}};
  }
};

inline Eigen::Vector3d tilted(const Eigen::Vector3d& direction, double sigma, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, sigma);
  return (direction + Eigen::Vector3d(normal(random), normal(random), normal(random))).normalized();
}

/// A board's rig as a workshop delivers it: axes, offsets, lens and command curve a little off the drawing.
inline SteeredRig steered_rig(const std::string& board_name, std::mt19937_64& random) {
  std::ostringstream text;
  text << std::ifstream(source_root() / "boards" / (board_name + ".toml")).rdbuf();
  const auto board = proto::board::read_board(text.str(), board_name);
  auto truth = board ? sim::optics::rig_as_drawn(*board) : Result<sim::optics::TrueRig>(board.error());
  if (!truth) {
    throw std::runtime_error(truth.error().message());
  }
  SteeredRig rig{.truth = std::move(*truth), .projector = {}};
  std::normal_distribution<double> normal;
  sim::optics::LensNumbers lens = rig.truth.projector.lens.numbers();
  lens.focal_px *= 1 + 0.01 * normal(random);
  lens.centre_px += 20 * Eigen::Vector2d(normal(random), normal(random));
  lens.distortion = {-0.05 + 0.01 * normal(random), 0.01 * normal(random), 1e-3 * normal(random), 1e-3 * normal(random),
                     0};
  rig.truth.projector.lens = sim::optics::Lens(lens);
  sim::optics::TrueMirror& mirror = rig.truth.mirror;
  calib::model::SteeredProjector& projector = rig.projector;
  projector.lens = {.width = rig.truth.projector.width,
                    .height = rig.truth.projector.height,
                    .fx = lens.focal_px.x(),
                    .fy = lens.focal_px.y(),
                    .cx = lens.centre_px.x(),
                    .cy = lens.centre_px.y()};
  std::copy_n(lens.distortion.begin(), 4, projector.lens.k.begin());
  projector.T_projector_rig = {.q = Eigen::Quaterniond(rig.truth.projector.T_projector_rig.linear()),
                               .t = rig.truth.projector.T_projector_rig.translation()};
  projector.kind = mirror.head ? calib::model::MirrorKind::kHead : calib::model::MirrorKind::kGalvoPair;
  for (std::size_t k = 0; k < static_cast<std::size_t>(mirror.count()); ++k) {
    sim::optics::MirrorPart& part = mirror.parts[k];
    part.axis = tilted(part.axis, 0.01, random);
    part.normal = tilted(part.normal, 0.01, random);
    part.point += 0.001 * Eigen::Vector3d(normal(random), normal(random), normal(random));
    projector.parts[k] = {.axis = part.axis,
                          .point = part.point,
                          .normal = part.normal,
                          .offset_m = part.offset_m,
                          .size_m = 2 * part.half_size_m,
                          .ellipse = part.ellipse};
  }
  mirror.outer_axis = tilted(mirror.outer_axis, 0.01, random);
  projector.outer_axis = mirror.outer_axis;
  projector.outer_point = mirror.outer_point;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const int i = static_cast<int>(axis);
    projector.least_rad[i] = board->mirror.least_rad[axis];
    projector.most_rad[i] = board->mirror.most_rad[axis];
    projector.curves[axis] = {.half_range = board->mirror.half_range_rad[axis],
                              .gain = 0.02 * normal(random),
                              .quadratic = 0.003 * normal(random),
                              .cubic = 0.003 * normal(random),
                              .cross_talk = 0.001 * normal(random)};
  }
  return rig;
}

/// The floor 3.5 m before the rig, tilted a little, its x and y roughly the rig's.
inline calib::model::Pose floor_pose(std::mt19937_64& random, double tilt_rad = 0.05) {
  std::uniform_real_distribution<double> turn(-1, 1);
  const double about = std::numbers::pi * turn(random);
  return {.q = calib::model::rotation_by(tilt_rad * Eigen::Vector3d(std::cos(about), std::sin(about), 0)),
          .t = {0, 0, 3.5}};
}

inline calib::bake::Station station_at(const std::string& name, const calib::model::Pose& T_rig_floor, double x,
                                       double y, double turn_rad, const Eigen::Vector2d& size_m = {0.5, 0.3125}) {
  calib::bake::Station station;
  station.name = name;
  station.T_rig_plane =
      T_rig_floor * calib::model::Pose{.q = calib::model::rotation_by({0, 0, turn_rad}), .t = {x, y, 0}};
  station.size_m = size_m;
  return station;
}

}  // namespace raysteer::support
