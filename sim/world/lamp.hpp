// value: the projector at one mirror position, as light that falls on surfaces.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>

#include "hal/mirror.hpp"
#include "sim/optics/light_path.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/world/shapes.hpp"
#include "sim/world/smooth.hpp"

namespace raysteer::sim::world {

/// Of a panel's surroundings so much is looked at: blur carries light that far out.
inline constexpr int kPanelBorderPx = 48;

/// Candela of each panel pixel's neighbourhood when it is white.
Smooth intensity_map(const optics::TrueProjector& projector);

class Lamp {
 public:
  /// `intensity`: intensity_map() of the rig's projector.
  Lamp(const optics::TrueRig& rig, std::shared_ptr<const Smooth> intensity, hal::MirrorAngles angles);

  const optics::LightPath& path() const { return path_; }
  /// From here light seems to come; it truly comes from the same direction.
  const Eigen::Vector3d& centre() const { return centre_; }

  /// The panel pixel whose light goes towards a point; nothing when that is not on the panel or near it.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& p) const {
    const auto x = path_.pixel(p);
    const bool near = x && x->x() > -kPanelBorderPx && x->y() > -kPanelBorderPx && x->x() < width_ + kPanelBorderPx &&
                      x->y() < height_ + kPanelBorderPx;
    return near ? x : std::nullopt;
  }

  /// Candela of the panel's neighbourhood of `x` when it is white.
  double intensity(const Eigen::Vector2d& x) const { return (*intensity_)(x.x(), x.y()); }

  /// Light on a surface, lux, and what of it one camera's pixel gets.
  struct Falls {
    double lux = 0;
    double blur_px = 0;  ///< standard deviation on the panel
    double gloss = 0;    ///< per steradian, towards `to_camera`
  };
  Falls falls(const Eigen::Vector3d& p, const Eigen::Vector3d& normal, const Eigen::Vector2d& x,
              const scene::Material& material, const Eigen::Vector3d& to_camera) const;

 private:
  optics::TrueProjector projector_;
  double width_;
  double height_;
  optics::LightPath path_;
  Eigen::Vector3d centre_;
  Eigen::Vector3d axis_;  ///< of the virtual projector: depth grows along it
  std::shared_ptr<const Smooth> intensity_;
};

}  // namespace raysteer::sim::world
