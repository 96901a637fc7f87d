// value: for each panel pixel of one station the exact content coordinate and light, or that it shows nothing.
//
// Everything a warp map is made of and judged by. Exact: rays, mirrors, lens and planes in doubles.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "calib/bake/content.hpp"
#include "calib/bake/mirror_window.hpp"
#include "calib/bake/panel_rays.hpp"
#include "calib/bake/ray_caster.hpp"
#include "calib/model/steered_projector.hpp"
#include "proto/lut/keep_out.hpp"

namespace raysteer::calib::bake {

/// Zones in the plane of the steering table.
struct KeepOutFloor {
  model::Pose T_plane_rig{};
  std::span<const proto::lut::KeepOut> zones{};

  /// A point lies over or under a zone.
  bool forbids(const Eigen::Vector3d& p_rig) const;
};

struct LightOptions {
  double fall_off = 4;  ///< light of a panel pixel: cos^fall_off off the lens's axis
  double most_incidence_rad = 75 * std::numbers::pi / 180;  ///< flatter light is not used
  double shadow_m = 0.003;  ///< a surface nearer than the station's plane by more than this throws a shadow
};

/// Where a ray meets its surface, and what is shown there.
struct Placed {
  Eigen::Vector3d
      uvw;  ///< homogeneous content pixels over depth: linear over the panel on every plane, but for the lens
  double inverse_depth = 0;  ///< 1 / s, s counted in lengths of m
  double light = 0;          ///< of the panel pixel on the surface, any unit; 0 where it does not reach

  Eigen::Vector2d content() const { return uvw.hnormalized(); }
};

/// One station at one command.
class StationView {
 public:
  /// `scene`: the scanned surface; may be null when the content has a plane, which then nothing shadows.
  StationView(const model::SteeredProjector& projector, const Eigen::Vector2d& command_rad, const Content& content,
              const RayCaster* scene, const KeepOutFloor& floor, const LightOptions& options);

  const Content& content() const { return content_; }
  /// Without asking whether anything is lit: also beside the panel and the rectangle. Nothing where there is no surface
  /// before the lens.
  void place(std::span<const PanelRay> rays, std::vector<std::optional<Placed>>& placed) const;
  /// With every mask: mirror outlines, the content's edge, shadow, flat light, zones.
  void lit(std::span<const PanelRay> rays, std::vector<std::optional<Placed>>& placed) const;

 private:
  Placed placed_on(const SurfacePlane& plane, const PanelRay& ray) const;
  double light(const Placed& placed, const SurfacePlane& plane, const PanelRay& ray) const;
  bool shows(const Placed& placed, const SurfacePlane& plane, const PanelRay& ray) const;
  void set_box();
  void cast(std::span<const PanelRay> rays, std::vector<std::uint32_t>& triangles) const;

  Content content_;
  const RayCaster* scene_;
  KeepOutFloor floor_;
  LightOptions options_;
  MirrorWindow window_;
  Eigen::AlignedBox2d box_;  ///< of (X/Z, Y/Z): outside it a plane shows none of the content
  Eigen::Matrix3d R_rig_lens_;
  Eigen::Vector3d centre_;
  Eigen::Matrix3d by_ray_;  ///< uvw = by_ray m + by_inverse_depth / s
  Eigen::Vector3d by_depth_;
};

}  // namespace raysteer::calib::bake
