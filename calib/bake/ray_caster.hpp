// shared: triangles in space, and which of them rays meet. Embree says which, doubles say where.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "calib/bake/content.hpp"
#include "calib/model/pose.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::bake {

struct TriangleMesh {
  std::vector<Eigen::Vector3d> points;  ///< rig frame, metres
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Two triangles between each four neighbouring heights: the point of heights(i, j) is (i * spacing, j * spacing,
/// height) in the grid's frame. Heights that are not finite are holes.
TriangleMesh height_field(const model::Pose& T_rig_grid, double spacing_m, ImageView<const double> heights_m);

class RayCaster {
 public:
  static constexpr std::uint32_t kNothing = 0xffffffff;

  /// Errors: kMeshIndex, kMeshNotFinite, kMeshEmpty (no triangle with an area).
  static Result<RayCaster> make(TriangleMesh mesh);
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;
  ~RayCaster();

  /// The first triangle that origin + s direction meets with s > nearest, or kNothing; for each direction.
  void first(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
             std::span<const double> nearest, std::span<std::uint32_t> triangles) const;
  /// The same for one way, anywhere on it.
  std::optional<std::uint32_t> first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
  const TriangleMesh& mesh() const { return mesh_; }
  /// Its plane.
  const SurfacePlane& plane(std::uint32_t triangle) const { return planes_[triangle]; }

 private:
  struct Embree;
  explicit RayCaster(TriangleMesh mesh);

  TriangleMesh mesh_;
  std::vector<SurfacePlane> planes_;
  std::unique_ptr<Embree> embree_;
};

}  // namespace raysteer::calib::bake
