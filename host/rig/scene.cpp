#include "host/rig/scene.hpp"

#include <algorithm>
#include <utility>

#include "host/exchange/surface_file.hpp"

namespace raysteer::host::rig {

std::optional<ScannedPlace> Scene::first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  const auto triangle = surface.first(origin, direction);
  if (!triangle) {
    return std::nullopt;
  }
  const calib::bake::SurfacePlane& plane = surface.plane(*triangle);
  const double way = (plane.distance_m - plane.normal.dot(origin)) / plane.normal.dot(direction);
  ScannedPlace place{.p = origin + way * direction, .normal = plane.normal};
  for (const std::uint32_t corner : surface.mesh().triangles[*triangle]) {
    place.sigma_m = std::max(place.sigma_m, double{sigma_m[corner]});
  }
  return place;
}

Result<Scene> read_scene(const std::string& path, const std::string& rig_id) {
  auto file = exchange::read_surface(path);
  RAYSTEER_TRY(file);
  if (file->rig_id != rig_id) {
    return fail(RCode::kCalibrationMismatch, path + " was scanned with calibration " + file->rig_id +
                                                 " of the rig, this one is " + rig_id + "; scan it again");
  }
  std::vector<float> sorted = file->sigma_m;
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sorted.size() - 1));
  std::ranges::nth_element(sorted, at);
  const double sigma_95_m = *at;
  auto surface =
      calib::bake::RayCaster::make({.points = std::move(file->points), .triangles = std::move(file->triangles)});
  RAYSTEER_TRY(surface);
  return Scene{.surface = *std::move(surface), .sigma_m = std::move(file->sigma_m), .sigma_95_m = sigma_95_m};
}

}  // namespace raysteer::host::rig
