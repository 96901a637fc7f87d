// pure: small rooms, pictures and exposures for tests of the world.
#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "hal/mock/exposure.hpp"
#include "proto/board/board.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/scene/mesh.hpp"
#include "sim/scene/scene.hpp"
#include "sim/world/world.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::sim::world {

inline optics::TrueRig rig_named(const std::string& name) {
  const auto path = support::source_root() / "boards" / (name + ".toml");
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  const auto board = proto::board::read_board(text.str(), path.filename().string());
  auto rig = board ? optics::rig_as_drawn(*board) : Result<optics::TrueRig>(board.error());
  if (!rig) {
    throw std::runtime_error(rig.error().message());
  }
  return *rig;
}

inline hal::MirrorAngles mrad(double axis1, double axis2) { return {Radians(axis1 * 1e-3), Radians(axis2 * 1e-3)}; }

/// The room's frame is the rig's in these tests: surfaces are placed as the cameras see them.
inline scene::Surface surface(const std::string& name, scene::Mesh mesh, double albedo,
                              const Eigen::Vector3d& place = Eigen::Vector3d::Zero(),
                              const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  scene::Surface one;
  one.name = name;
  one.mesh = std::move(mesh);
  one.material.albedo = albedo;
  one.T_room_surface.translation() = place;
  if (turn.norm() > 0) {
    one.T_room_surface.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return one;
}

/// A wall across the whole view, `distance` before the rig.
inline scene::Scene wall(double distance, double albedo = 0.6, const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  scene::Scene room;
  room.surfaces.push_back(surface("wall", scene::rectangle(-8, -8, 8, 8), albedo, {0, 0, distance}, turn));
  return room;
}

/// A wall and a board before it, whose edges and shadow cross the picture.
inline scene::Scene wall_and_board(double distance, double lift = 0.4) {
  scene::Scene room = wall(distance);
  room.surfaces.push_back(surface("board", scene::rectangle(-0.3, -0.25, 0.35, 0.2), 0.3, {0.15, 0.1, distance - lift},
                                  {0.15, -0.2, 0.35}));
  return room;
}

inline std::array<float, 256> linear_response(float black = 0) {
  std::array<float, 256> response{};
  for (std::size_t i = 0; i < 256; ++i) {
    response[i] = black + (1 - black) * static_cast<float>(i) / 255;
  }
  return response;
}

/// Value(x) of each column or row, 0 to 1.
template <class Value>
std::shared_ptr<hal::mock::PanelPicture> stripes(const optics::TrueRig& rig, Axis axis, const Value& value) {
  auto picture = std::make_shared<hal::mock::PanelPicture>();
  picture->width = rig.projector.width;
  picture->height = rig.projector.height;
  picture->along = axis;
  picture->response = linear_response();
  const int count = axis == Axis::kX ? picture->width : picture->height;
  for (int i = 0; i < count; ++i) {
    picture->profile.push_back(static_cast<std::uint8_t>(std::lround(255.0 * value(i))));
  }
  return picture;
}

inline std::shared_ptr<hal::mock::PanelPicture> plain(const optics::TrueRig& rig, double value) {
  return stripes(rig, Axis::kX, [=](int) { return value; });
}

template <class Value>
std::shared_ptr<hal::mock::PanelPicture> picture(const optics::TrueRig& rig, const Value& value) {
  auto picture = std::make_shared<hal::mock::PanelPicture>();
  picture->width = rig.projector.width;
  picture->height = rig.projector.height;
  picture->response = linear_response();
  picture->pixels = Image<std::uint8_t>(picture->width, picture->height);
  for (int y = 0; y < picture->height; ++y) {
    for (int x = 0; x < picture->width; ++x) {
      picture->pixels(x, y) = static_cast<std::uint8_t>(std::lround(255.0 * value(x, y)));
    }
  }
  return picture;
}

inline RigTime at_ms(double ms) { return RigTime(std::chrono::nanoseconds(std::llround(ms * 1e6))); }

/// The picture shown all through an exposure of 10 ms.
inline hal::mock::Exposure exposure(std::shared_ptr<const hal::mock::PanelPicture> shown, hal::MirrorAngles mirror,
                                    hal::Eye eye = hal::Eye::kLeft) {
  hal::mock::Exposure exposure;
  exposure.eye = eye;
  exposure.begin = at_ms(100);
  exposure.duration = std::chrono::milliseconds(10);
  if (shown) {
    hal::mock::LightSpan span;
    span.begin = at_ms(100);
    span.end = at_ms(110);
    span.end_row = shown->height;
    span.picture = std::move(shown);
    span.mirror = mirror;
    exposure.light.push_back(span);
  }
  return exposure;
}

}  // namespace raysteer::sim::world
