// bound to the caller's thread: the pretend rig inside its room: what its cameras see, and what is true.
//
// Geometry is traced once per look and moment (Embree) and kept; a further pattern costs a resampling. What is modelled
// and what is not: docs/pretend-rig.md.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/units.hpp"
#include "hal/mock/exposure.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/scene/scene.hpp"

namespace raysteer::sim::world {

struct WorldOptions {
  int threads = 2;
  /// Light that comes by way of one other surface (bounce.hpp).
  bool interreflection = false;
  /// Traced looks kept for another visit; two looks of both eyes always are.
  std::size_t cache_bytes = std::size_t{256} << 20U;
};

/// Where projected light lands.
struct LitPoint {
  Eigen::Vector3d p;        ///< rig frame, metres
  std::size_t surface = 0;  ///< in Scene::surfaces
};

/// A person's view of the room: a pinhole without distortion, its principal point in the middle.
struct RoomView {
  int width = 800;
  int height = 600;
  double focal_px = 700;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();  ///< rig frame, metres
  Eigen::Vector3d look_at = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< any direction that is up in the picture
};

class World {
 public:
  World(optics::TrueRig rig, scene::Scene scene, WorldOptions options = {});
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  ~World();

  const optics::TrueRig& rig() const;
  const scene::Scene& scene() const;

  /// Scene::target_pose() of what a person was last told; 0 at first.
  void set_target_pose(int pose);

  /// Mean electrons: hal::mock::SceneFunction. Depends on nothing but the exposure and the target's pose.
  Image<float> draw(const hal::mock::Exposure& exposure);

  /// Where the light of a panel position (also between pixels) first meets the room; nothing when it misses a mirror or
  /// meets nothing. `at`: for things that move.
  std::optional<LitPoint> lit_point(hal::MirrorAngles mirror, ProjectorPx x, RigTime at = {});

  /// The panel position that lights a point in the rig's frame; nothing when it is off the panel, a mirror's outline
  /// stops the light, or something stands in the way (a surface within 0.1 mm of the point does not).
  std::optional<ProjectorPx> panel_pixel(hal::MirrorAngles mirror, const Eigen::Vector3d& p, RigTime at = {});

  /// What a person sees of the room during an exposure (its eye does not matter): grey, the brightest white near 255,
  /// with the eye's gamma.
  Image<std::uint8_t> room_picture(const RoomView& view, const hal::mock::Exposure& exposure);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The pixel at which a room picture shows a point; nothing behind the viewer.
std::optional<Eigen::Vector2d> room_pixel(const RoomView& view, const Eigen::Vector3d& p);

}  // namespace raysteer::sim::world
