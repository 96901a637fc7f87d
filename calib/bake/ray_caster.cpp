#include "calib/bake/ray_caster.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raysteer::calib::bake {
namespace {

constexpr std::size_t kBundle = 8;

}  // namespace

TriangleMesh height_field(const model::Pose& T_rig_grid, double spacing_m, ImageView<const double> heights_m) {
  TriangleMesh mesh;
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * heights_m.width() + i); };
  for (int j = 0; j < heights_m.height(); ++j) {
    for (int i = 0; i < heights_m.width(); ++i) {
      const double height = heights_m(i, j);
      mesh.points.push_back(T_rig_grid *
                            Eigen::Vector3d(spacing_m * i, spacing_m * j, std::isfinite(height) ? height : 0));
    }
  }
  const auto add = [&](const std::array<std::pair<int, int>, 3>& corners) {
    if (std::ranges::all_of(corners, [&](const auto& at) { return std::isfinite(heights_m(at.first, at.second)); })) {
      mesh.triangles.push_back({index(corners[0].first, corners[0].second), index(corners[1].first, corners[1].second),
                                index(corners[2].first, corners[2].second)});
    }
  };
  for (int j = 0; j + 1 < heights_m.height(); ++j) {
    for (int i = 0; i + 1 < heights_m.width(); ++i) {
      add({{{i, j}, {i + 1, j}, {i, j + 1}}});
      add({{{i + 1, j}, {i + 1, j + 1}, {i, j + 1}}});
    }
  }
  return mesh;
}

struct RayCaster::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  explicit Embree(const TriangleMesh& mesh) {
    // One thread builds, so that the same mesh is the same tree.
    device = rtcNewDevice("threads=1");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh.points.size()));
    for (const Eigen::Vector3d& p : mesh.points) {
      for (int axis = 0; axis < 3; ++axis) {
        *points++ = static_cast<float>(p[axis]);
      }
    }
    auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles) {
      corners = std::copy(triangle.begin(), triangle.end(), corners);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

RayCaster::RayCaster(TriangleMesh mesh) : mesh_(std::move(mesh)) {
  for (const auto& [a, b, c] : mesh_.triangles) {
    const Eigen::Vector3d& at = mesh_.points[a];
    const Eigen::Vector3d normal = (mesh_.points[b] - at).cross(mesh_.points[c] - at).normalized();
    planes_.push_back({.normal = normal, .distance_m = normal.dot(at)});
  }
  embree_ = std::make_unique<Embree>(mesh_);
}
RayCaster::RayCaster(RayCaster&&) noexcept = default;
RayCaster& RayCaster::operator=(RayCaster&&) noexcept = default;
RayCaster::~RayCaster() = default;

Result<RayCaster> RayCaster::make(TriangleMesh mesh) {
  if (!std::ranges::all_of(mesh.points, [](const auto& p) { return p.allFinite(); })) {
    return fail(RCode::kMeshNotFinite, "a point of the scanned surface is not finite");
  }
  for (const auto& triangle : mesh.triangles) {
    if (std::ranges::any_of(triangle, [&](std::uint32_t i) { return i >= mesh.points.size(); })) {
      return fail(RCode::kMeshIndex, "a triangle of the scanned surface names a point that is not there");
    }
  }
  // No ray can meet a triangle without an area, and it has no plane.
  std::erase_if(mesh.triangles, [&](const auto& t) {
    const Eigen::Vector3d& at = mesh.points[t[0]];
    return !((mesh.points[t[1]] - at).cross(mesh.points[t[2]] - at).norm() > 1e-14);
  });
  if (mesh.triangles.empty()) {
    return fail(RCode::kMeshEmpty, "the scanned surface has no triangles");
  }
  return RayCaster(std::move(mesh));
}

void RayCaster::first(const Eigen::Vector3d& origin, std::span<const Eigen::Vector3d> directions,
                      std::span<const double> nearest, std::span<std::uint32_t> triangles) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const Eigen::Vector3f from = origin.cast<float>();
  for (std::size_t start = 0; start < directions.size(); start += kBundle) {
    const std::size_t count = std::min(kBundle, directions.size() - start);
    RTCRayHit8 rays{};
    alignas(32) std::array<int, kBundle> valid{};
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f along = directions[start + i].cast<float>();
      valid[i] = -1;
      rays.ray.org_x[i] = from.x();
      rays.ray.org_y[i] = from.y();
      rays.ray.org_z[i] = from.z();
      rays.ray.dir_x[i] = along.x();
      rays.ray.dir_y[i] = along.y();
      rays.ray.dir_z[i] = along.z();
      rays.ray.tnear[i] = static_cast<float>(nearest[start + i]);
      rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
      rays.ray.mask[i] = 0xffffffffU;
      rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid.data(), embree_->scene, &context, &rays);
    for (std::size_t i = 0; i < count; ++i) {
      triangles[start + i] = rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? kNothing : rays.hit.primID[i];
    }
  }
}

std::optional<std::uint32_t> RayCaster::first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  constexpr double kNearest = 0;
  std::uint32_t triangle = kNothing;
  first(origin, std::span(&direction, 1), std::span(&kNearest, 1), std::span(&triangle, 1));
  return triangle == kNothing ? std::nullopt : std::optional(triangle);
}

}  // namespace raysteer::calib::bake
