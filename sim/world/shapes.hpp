// value: the room's surfaces at one moment, in the rig's frame, ready for rays.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "sim/scene/scene.hpp"
#include "sim/world/tracer.hpp"

namespace raysteer::sim::world {

/// The scene must outlive it.
class Shapes {
 public:
  Shapes(const scene::Scene& scene, const scene::FlatScene& flat);

  const Tracer& tracer() const { return tracer_; }
  /// Index in Scene::surfaces.
  std::uint32_t surface(std::uint32_t triangle) const { return surface_[triangle]; }
  const scene::Material& material(std::uint32_t triangle) const {
    return scene_->surfaces[surface_[triangle]].material;
  }
  /// Unit, on the side of `towards`.
  Eigen::Vector3d normal(std::uint32_t triangle, const Eigen::Vector3d& towards) const {
    const Eigen::Vector3d& normal = tracer_.normal(triangle);
    return normal.dot(towards) < 0 ? Eigen::Vector3d(-normal) : normal;
  }
  /// Texture coordinates at a point of a triangle's plane.
  Eigen::Vector2d uv(std::uint32_t triangle, const Eigen::Vector3d& p) const;

  struct Albedo {
    double mean = 0;
    Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  ///< of the reflected light, pixels from the footprint's centre
  };
  /// Of the parallelogram about `p` with sides `across` and `down`: what one camera pixel sees.
  Albedo albedo(std::uint32_t triangle, const Eigen::Vector3d& p, const Eigen::Vector3d& across,
                const Eigen::Vector3d& down) const;

 private:
  const scene::Scene* scene_;
  Tracer tracer_;
  std::vector<std::uint32_t> surface_;
  std::vector<Eigen::Vector2d> uv_;
};

}  // namespace raysteer::sim::world
