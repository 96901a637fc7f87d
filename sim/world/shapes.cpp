#include "sim/world/shapes.hpp"

#include <algorithm>

#include "sim/world/lattice.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

Triangles in_rig_frame(const scene::Scene& scene, const scene::FlatScene& flat) {
  const Eigen::Isometry3d T_rig_room = scene.T_room_rig.inverse();
  Triangles triangles;
  triangles.points.reserve(flat.vertices.size());
  for (const Vector3d& p : flat.vertices) {
    triangles.points.push_back(T_rig_room * p);
  }
  triangles.corners.assign(flat.triangles.begin(), flat.triangles.end());
  return triangles;
}

}  // namespace

Shapes::Shapes(const scene::Scene& scene, const scene::FlatScene& flat)
    : scene_(&scene), tracer_(in_rig_frame(scene, flat)), surface_(flat.surface), uv_(flat.uv) {}

Vector2d Shapes::uv(std::uint32_t triangle, const Vector3d& p) const {
  const Triangles& all = tracer_.triangles();
  const auto [a, b, c] = all.corners[triangle];
  const Vector3d side_b = all.points[b] - all.points[a];
  const Vector3d side_c = all.points[c] - all.points[a];
  const Vector3d at = p - all.points[a];
  // barycentric coordinates by the normal equations of at = s side_b + t side_c
  const double bb = side_b.squaredNorm();
  const double bc = side_b.dot(side_c);
  const double cc = side_c.squaredNorm();
  const double b_at = side_b.dot(at);
  const double c_at = side_c.dot(at);
  const double area = bb * cc - bc * bc;
  const double s = (cc * b_at - bc * c_at) / area;
  const double t = (bb * c_at - bc * b_at) / area;
  return uv_[a] + s * (uv_[b] - uv_[a]) + t * (uv_[c] - uv_[a]);
}

Shapes::Albedo Shapes::albedo(std::uint32_t triangle, const Vector3d& p, const Vector3d& across,
                              const Vector3d& down) const {
  const scene::Material& of = material(triangle);
  if (!of.texture) {
    return {.mean = of.albedo};
  }
  const Vector2d at = uv(triangle, p);
  const Vector2d right = uv(triangle, p + across) - at;
  const Vector2d below = uv(triangle, p + down) - at;
  // Most pixels lie whole in one colour; a corner or an edge between these points is wider than a pixel's half.
  const double middle = of.texture->albedo(at);
  bool plain = true;
  for (const Vector2d& corner : {Vector2d(-0.5, -0.5), Vector2d(0.5, -0.5), Vector2d(-0.5, 0.5), Vector2d(0.5, 0.5)}) {
    plain = plain && std::abs(of.texture->albedo(at + corner.x() * right + corner.y() * below) - middle) < 1e-4;
  }
  if (plain) {
    return {.mean = middle};
  }
  double sum = 0;
  Vector2d moment = Vector2d::Zero();
  for (const Vector2d& sample : samples()) {
    const double here = of.texture->albedo(at + sample.x() * right + sample.y() * below);
    sum += here;
    moment += here * sample;
  }
  return {.mean = sum / kSamples, .centroid = sum > 0 ? Vector2d(moment / sum) : Vector2d::Zero()};
}

}  // namespace raysteer::sim::world
