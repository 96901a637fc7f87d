#include "sim/world/tracer.hpp"

#include <embree3/rtcore.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace raysteer::sim::world {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// A shadow ray begins so far off its surface: more than a float's rounding at 100 m, less than anything one sees.
constexpr double kLiftM = 2e-5;
constexpr std::size_t kBundle = 8;

}  // namespace

struct Tracer::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  explicit Embree(const Triangles& triangles) {
    // One thread builds, so that the same scene is the same tree.
    device = rtcNewDevice("threads=1");
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
    if (!triangles.corners.empty()) {
      RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
      auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), triangles.points.size()));
      for (const Vector3d& p : triangles.points) {
        for (int axis = 0; axis < 3; ++axis) {
          *points++ = static_cast<float>(p[axis]);
        }
      }
      auto* corners = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
          geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), triangles.corners.size()));
      for (const auto& triangle : triangles.corners) {
        corners = std::copy(triangle.begin(), triangle.end(), corners);
      }
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
  }
  Embree(const Embree&) = delete;
  Embree& operator=(const Embree&) = delete;
  ~Embree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
};

Tracer::Tracer(Triangles triangles) : triangles_(std::move(triangles)) {
  for (const auto& [a, b, c] : triangles_.corners) {
    const Vector3d& at = triangles_.points[a];
    const Vector3d across = (triangles_.points[b] - at).cross(triangles_.points[c] - at);
    normals_.push_back(across.normalized());  // zero for a triangle without area, which no ray meets
    planes_.push_back(normals_.back().dot(at));
  }
  embree_ = std::make_unique<Embree>(triangles_);
}

Tracer::Tracer(Tracer&&) noexcept = default;
Tracer& Tracer::operator=(Tracer&&) noexcept = default;
Tracer::~Tracer() = default;

void Tracer::nearest(const Vector3d& origin, std::span<const Vector3d> directions,
                     std::span<std::uint32_t> triangles) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  const Vector3f from = origin.cast<float>();
  for (std::size_t first = 0; first < directions.size(); first += kBundle) {
    const std::size_t count = std::min(kBundle, directions.size() - first);
    alignas(32) RTCRayHit8 rays;
    alignas(32) int valid[kBundle] = {};
    for (std::size_t i = 0; i < kBundle; ++i) {
      const Vector3f direction = directions[first + std::min(i, count - 1)].cast<float>();
      valid[i] = i < count && direction.allFinite() ? -1 : 0;
      rays.ray.org_x[i] = from.x();
      rays.ray.org_y[i] = from.y();
      rays.ray.org_z[i] = from.z();
      rays.ray.dir_x[i] = direction.x();
      rays.ray.dir_y[i] = direction.y();
      rays.ray.dir_z[i] = direction.z();
      rays.ray.tnear[i] = 0;
      rays.ray.tfar[i] = std::numeric_limits<float>::infinity();
      rays.ray.time[i] = 0;
      rays.ray.mask[i] = 0xffffffffU;
      rays.ray.id[i] = 0;
      rays.ray.flags[i] = 0;
      rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      rays.hit.primID[i] = kNothing;
      rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect8(valid, embree_->scene, &context, &rays);
    for (std::size_t i = 0; i < count; ++i) {
      triangles[first + i] = rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? kNothing : rays.hit.primID[i];
    }
  }
}

std::uint32_t Tracer::nearest(const Vector3d& origin, const Vector3d& direction) const {
  std::uint32_t triangle = kNothing;
  nearest(origin, {&direction, 1}, {&triangle, 1});
  return triangle;
}

Tracer::Shadow Tracer::shadow(const Vector3d& p, const Vector3d& normal, const Vector3d& light) {
  return {(p + kLiftM * normal).cast<float>(), light.cast<float>()};
}

void Tracer::blocked(std::span<const Shadow> rays, std::span<std::uint8_t> blocked) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  for (std::size_t first = 0; first < rays.size(); first += kBundle) {
    const std::size_t count = std::min(kBundle, rays.size() - first);
    alignas(32) RTCRay8 bundle;
    alignas(32) int valid[kBundle] = {};
    for (std::size_t i = 0; i < kBundle; ++i) {
      const Shadow& ray = rays[first + std::min(i, count - 1)];
      const Vector3f direction = ray.to - ray.from;
      valid[i] = i < count ? -1 : 0;
      bundle.org_x[i] = ray.from.x();
      bundle.org_y[i] = ray.from.y();
      bundle.org_z[i] = ray.from.z();
      bundle.dir_x[i] = direction.x();
      bundle.dir_y[i] = direction.y();
      bundle.dir_z[i] = direction.z();
      bundle.tnear[i] = 0;
      bundle.tfar[i] = 1;
      bundle.time[i] = 0;
      bundle.mask[i] = 0xffffffffU;
      bundle.id[i] = 0;
      bundle.flags[i] = 0;
    }
    rtcOccluded8(valid, embree_->scene, &context, &bundle);
    for (std::size_t i = 0; i < count; ++i) {
      blocked[first + i] = bundle.tfar[i] < 0 ? 1 : 0;
    }
  }
}

bool Tracer::blocked(const Shadow& ray) const {
  std::uint8_t answer = 0;
  blocked({&ray, 1}, {&answer, 1});
  return answer != 0;
}

}  // namespace raysteer::sim::world
