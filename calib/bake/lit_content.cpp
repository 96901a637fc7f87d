#include "calib/bake/lit_content.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace raysteer::calib::bake {

bool KeepOutFloor::forbids(const Eigen::Vector3d& p_rig) const {
  if (zones.empty()) {
    return false;
  }
  const Eigen::Vector3d p = T_plane_rig * p_rig;
  return std::ranges::any_of(zones, [&](const auto& zone) { return zone.contains({p.x(), p.y()}); });
}

StationView::StationView(const model::SteeredProjector& projector, const Eigen::Vector2d& command_rad,
                         const Content& content, const RayCaster* scene, const KeepOutFloor& floor,
                         const LightOptions& options)
    : content_(content), scene_(scene), floor_(floor), options_(options), window_(projector, command_rad) {
  const model::VirtualProjector view = projector.at(command_rad);
  R_rig_lens_ = view.rotation.transpose();
  centre_ = view.centre();
  by_ray_ = content.content_rig.leftCols<3>() * R_rig_lens_;
  by_depth_ = content.content_rig * centre_.homogeneous();
  set_box();
}

void StationView::set_box() {
  const double far = std::numeric_limits<double>::max();
  box_ = Eigen::AlignedBox2d(Eigen::Vector2d(-far, -far), Eigen::Vector2d(far, far));
  if (!content_.plane) {
    return;
  }
  // On a plane, content is a homography of (X/Z, Y/Z): the rectangle's corners bound it if all lie before the lens.
  const SurfacePlane& plane = *content_.plane;
  const Eigen::RowVector3d inverse_depth =
      plane.normal.transpose() * R_rig_lens_ / (plane.distance_m - plane.normal.dot(centre_));
  const Eigen::Matrix3d back = (by_ray_ + by_depth_ * inverse_depth).inverse();
  Eigen::AlignedBox2d box;
  for (const int u : {-1, content_.content_px.x()}) {
    for (const int v : {-1, content_.content_px.y()}) {
      const Eigen::Vector3d m = back * Eigen::Vector3d(u, v, 1);
      if (!(m.z() > 0)) {
        return;
      }
      box.extend(Eigen::Vector2d(m.hnormalized()));
    }
  }
  const Eigen::Vector2d rounding = 1e-9 * (Eigen::Vector2d::Ones() + box.sizes());
  box_ = Eigen::AlignedBox2d(box.min() - rounding, box.max() + rounding);
}

Placed StationView::placed_on(const SurfacePlane& plane, const PanelRay& ray) const {
  Placed placed;
  placed.inverse_depth = plane.normal.dot(R_rig_lens_ * ray.m) / (plane.distance_m - plane.normal.dot(centre_));
  placed.uvw = by_ray_ * ray.m + placed.inverse_depth * by_depth_;
  return placed;
}

double StationView::light(const Placed& placed, const SurfacePlane& plane, const PanelRay& ray) const {
  // Light a pixel sends (cos^fall_off) over the area it lights: solid angle cos^3 / magnify, distance 1 /
  // (inverse_depth cos), incidence |normal . along| cos.
  return std::pow(1 / ray.m.norm(), options_.fall_off) * ray.magnify * std::abs(plane.normal.dot(R_rig_lens_ * ray.m)) *
         placed.inverse_depth * placed.inverse_depth;
}

bool StationView::shows(const Placed& placed, const SurfacePlane& plane, const PanelRay& ray) const {
  // One content pixel beside the content still shows some of it: what is between two pixels is mixed of both.
  const Eigen::Vector3d& uvw = placed.uvw;
  const double w = uvw.z();
  if (!(placed.inverse_depth > 0 && w > 0 && uvw.x() > -w && uvw.y() > -w && uvw.x() < content_.content_px.x() * w &&
        uvw.y() < content_.content_px.y() * w)) {
    return false;
  }
  const Eigen::Vector3d along = R_rig_lens_ * ray.m;
  return window_.passes(ray.m) && placed.inverse_depth < window_.inverse_exit(ray.m) &&
         std::abs(plane.normal.dot(along)) >= std::cos(options_.most_incidence_rad) * along.norm() &&
         !floor_.forbids(centre_ + along / placed.inverse_depth);
}

void StationView::cast(std::span<const PanelRay> rays, std::vector<std::uint32_t>& triangles) const {
  std::vector<Eigen::Vector3d> along(rays.size());
  std::vector<double> nearest(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    along[i] = R_rig_lens_ * rays[i].m;
    // What stands behind the mirrors is in nobody's way. Beside the outlines the last mirror may lie behind the lens.
    const double inverse = window_.inverse_exit(rays[i].m);
    nearest[i] = inverse > 0 ? 1 / inverse : 0;
  }
  triangles.resize(rays.size());
  scene_->first(centre_, along, nearest, triangles);
}

void StationView::place(std::span<const PanelRay> rays, std::vector<std::optional<Placed>>& placed) const {
  placed.assign(rays.size(), std::nullopt);
  std::vector<std::uint32_t> triangles;
  if (!content_.plane) {
    cast(rays, triangles);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!rays[i].valid() || (!content_.plane && triangles[i] == RayCaster::kNothing)) {
      continue;
    }
    const SurfacePlane& plane = content_.plane ? *content_.plane : scene_->plane(triangles[i]);
    Placed at = placed_on(plane, rays[i]);
    if (at.inverse_depth > 0) {
      at.light = light(at, plane, rays[i]);
      placed[i] = at;
    }
  }
}

void StationView::lit(std::span<const PanelRay> rays, std::vector<std::optional<Placed>>& placed) const {
  placed.assign(rays.size(), std::nullopt);
  // With a plane only what it shows is cast for shadows; without one every ray must find its surface first.
  std::vector<PanelRay> asked;
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!box_.contains(rays[i].m.head<2>())) {  // nor is what is no number
      continue;
    }
    if (content_.plane) {
      Placed at = placed_on(*content_.plane, rays[i]);
      if (!shows(at, *content_.plane, rays[i])) {
        continue;
      }
      at.light = light(at, *content_.plane, rays[i]);
      placed[i] = at;
    } else if (!window_.passes(rays[i].m)) {
      continue;
    }
    if (scene_ != nullptr) {
      asked.push_back(rays[i]);
      places.push_back(i);
    }
  }
  if (asked.empty()) {
    return;
  }
  std::vector<std::uint32_t> triangles;
  cast(asked, triangles);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    std::optional<Placed>& here = placed[places[k]];
    if (triangles[k] == RayCaster::kNothing) {
      continue;
    }
    const SurfacePlane& plane = scene_->plane(triangles[k]);
    Placed at = placed_on(plane, asked[k]);
    if (here) {
      const double before_m = (1 / here->inverse_depth - 1 / at.inverse_depth) * asked[k].m.norm();
      if (before_m > options_.shadow_m) {
        here.reset();
      }
    } else if (shows(at, plane, asked[k])) {
      at.light = light(at, plane, asked[k]);
      here = at;
    }
  }
}

}  // namespace raysteer::calib::bake
