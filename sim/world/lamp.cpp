#include "sim/world/lamp.hpp"

#include "sim/world/light.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

Smooth intensity_map(const optics::TrueProjector& projector) {
  return {projector.width, projector.height, kPanelBorderPx, [&](const Vector2d& x) {
            const double candela = panel_intensity(projector, x);
            return std::isfinite(candela) ? candela : 0;  // beyond the lens's fold
          }};
}

Lamp::Lamp(const optics::TrueRig& rig, std::shared_ptr<const Smooth> intensity, hal::MirrorAngles angles)
    : projector_(rig.projector),
      width_(rig.projector.width),
      height_(rig.projector.height),
      path_(rig, angles),
      centre_(path_.centre()),
      axis_(path_.T_virtual_rig().linear().row(2)),
      intensity_(std::move(intensity)) {}

Lamp::Falls Lamp::falls(const Vector3d& p, const Vector3d& normal, const Vector2d& x, const scene::Material& material,
                        const Vector3d& to_camera) const {
  const Vector3d way = centre_ - p;
  const double distance = way.norm();
  const Vector3d to_light = way / distance;
  return {.lux = intensity(x) * normal.dot(to_light) / (distance * distance),
          .blur_px = projector_blur_px(projector_, -axis_.dot(way)),
          .gloss = gloss_lobe(material.gloss, material.gloss_rad, normal, to_light, to_camera)};
}

}  // namespace raysteer::sim::world
