// value: triangles, and the generators of those that need no file.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace raysteer::sim::scene {

using Triangle = std::array<std::uint32_t, 3>;

/// Metres. Both sides are seen and lit. `uv` are metres along the surface for its texture, one per vertex, or none.
struct Mesh {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector2d> uv;
};

/// A rectangle in z = 0, from (x0, y0) to (x1, y1); uv = (x, y).
Mesh rectangle(double x0, double y0, double x1, double y1);

/// A box that stands on z = 0 around the z axis, size along x, y and z; without its bottom.
Mesh box(const Eigen::Vector3d& size);

/// Some stairs up along x, each `depth` by `width` by `height`, beginning at x = 0 and centred on y = 0.
Mesh stairs(int count, double depth, double width, double height);

/// A pressed sheet like a car door's outer skin, lying on z = 0 around the z axis: curved both ways by `crown` metres,
/// with a crease along it and a handle's bowl. `cell` is the side of its triangles; uv = (x, y).
Mesh door(double length, double width, double crown, double cell);
/// Its height at (x, y), the surface the triangles approximate.
double door_height(double length, double width, double crown, double x, double y);

/// A standing person: a column with a head, `height` tall, on z = 0 around the z axis.
Mesh person(double height);

}  // namespace raysteer::sim::scene
