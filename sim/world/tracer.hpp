// value: triangles that rays can be asked about. Embree finds which triangle; where on it is computed anew in double.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace raysteer::sim::world {

/// Triangles of the rig's frame, metres.
struct Triangles {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<std::uint32_t, 3>> corners;
};

/// May be asked from several threads at once.
class Tracer {
 public:
  static constexpr std::uint32_t kNothing = 0xffffffffU;

  explicit Tracer(Triangles triangles);
  Tracer(Tracer&&) noexcept;
  Tracer& operator=(Tracer&&) noexcept;
  ~Tracer();

  const Triangles& triangles() const { return triangles_; }
  /// Unit, by the order of the corners.
  const Eigen::Vector3d& normal(std::uint32_t triangle) const { return normals_[triangle]; }

  /// The first triangle each ray meets. A direction that is not a number meets nothing.
  void nearest(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
               std::span<std::uint32_t> triangles) const;
  std::uint32_t nearest(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;

  /// Where the ray meets the triangle's plane, in lengths of `direction`.
  double meets(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, std::uint32_t triangle) const {
    return (planes_[triangle] - normals_[triangle].dot(origin)) / normals_[triangle].dot(direction);
  }

  /// A shadow ray: from a point of a surface, lifted a little off it along `normal`, to where the light comes from.
  struct Shadow {
    Eigen::Vector3f from;
    Eigen::Vector3f to;
  };
  static Shadow shadow(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, const Eigen::Vector3d& light);
  /// Does anything stand between?
  void blocked(std::span<const Shadow> rays, std::span<std::uint8_t> blocked) const;
  bool blocked(const Shadow& ray) const;

 private:
  struct Embree;
  Triangles triangles_;
  std::vector<Eigen::Vector3d> normals_;
  std::vector<double> planes_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace raysteer::sim::world
