// value: the pretend room: what stands in it, how it is lit, where the rig hangs, and what changes with time.
//
// Room frame: right-handed, z up, floor at z = 0; metres. docs/scene-format.md.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "hal/base/target.hpp"
#include "hal/base/time.hpp"
#include "sim/scene/mesh.hpp"
#include "sim/scene/texture.hpp"

namespace raysteer::sim::scene {

struct Material {
  double albedo = 0.5;      ///< diffuse reflectance, where there is no texture
  double gloss = 0;         ///< share of light reflected like a blurred mirror, on top
  double gloss_rad = 0.05;  ///< how much it is blurred: standard deviation of the lobe
  std::optional<Texture> texture;
};

/// Where a person has put the target: held in pose 1, 2, ..., or
inline constexpr int kTargetAway = -1;
inline constexpr int kTargetOnFloor = 0;

/// The moment a picture of the room is taken. What a person was told to do is part of it.
struct Moment {
  RigTime time{};
  int target_pose = kTargetAway;  ///< Scene::target_pose() of a plan's `prepare`
};

/// Where a moving thing is at a time; in between it walks straight. Before the first it stands at the first.
struct Waypoint {
  double time_s = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

struct Surface {
  std::string name;
  Mesh mesh;  ///< in the surface's own frame
  Material material;
  Eigen::Isometry3d T_room_surface = Eigen::Isometry3d::Identity();
  double appears_s = 0;
  double vanishes_s = std::numeric_limits<double>::infinity();
  std::vector<Waypoint> path;  ///< not empty: it moves; added to T_room_surface's translation
  bool path_repeats = false;
  bool is_target = false;
  bool rests = false;                           ///< a target: kTargetOnFloor is at T_room_surface
  std::vector<Eigen::Isometry3d> T_room_poses;  ///< a target: where it is held in pose 1, 2, ...

  bool moves() const { return !path.empty(); }
  /// Where it is at a moment; nothing when it is not in the room.
  std::optional<Eigen::Isometry3d> pose(const Moment& moment) const;
};

struct Ambient {
  double lux = 0;            ///< on every surface, mean over time
  double flicker_hz = 0;     ///< 100 for lamps on 50-Hz mains
  double flicker_depth = 0;  ///< lux * (1 + depth * sin(2 pi hz t))
};

/// A printed target and which surface it is.
struct PlacedTarget {
  TargetSpec spec;
  std::size_t surface = 0;
};

struct Scene {
  std::string name;
  Ambient ambient;
  Eigen::Isometry3d T_room_rig = Eigen::Isometry3d::Identity();
  std::vector<Surface> surfaces;
  std::vector<PlacedTarget> targets;  ///< their frame: first inner corner, x along columns, y along rows, z into it

  /// What a plan's `prepare` asks of whoever holds the target, which is `now` somewhere: "" changes nothing; "target
  /// pose 3", "target on floor", "target away". kBadPrepare: something else, or what no target of this scene can do.
  Result<int> target_pose(std::string_view prepare, int now = kTargetAway) const;
};

/// The surfaces present at a moment as flat arrays in the room frame, for a ray tracer.
struct FlatScene {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector2d> uv;  ///< one per vertex; zero where the surface has none
  std::vector<Triangle> triangles;
  std::vector<std::uint32_t> surface;  ///< of each triangle: index in Scene::surfaces
};
/// `which`: all, or only what stands still, or only what moves.
enum class Which { kAll, kStill, kMoving };
FlatScene flatten(const Scene& scene, const Moment& moment, Which which = Which::kAll);

/// Equal numbers, equal still surfaces: what may be cached between two moments.
std::uint64_t still_key(const Scene& scene, const Moment& moment);

}  // namespace raysteer::sim::scene
