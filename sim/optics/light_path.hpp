// value: the way of the projector's light at one mirror position, both ways, in closed form. Frame of results: the
// rig's.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <optional>

#include "hal/mirror.hpp"
#include "sim/optics/true_rig.hpp"

namespace raysteer::sim::optics {

/// What happened to a ray on its way out of the rig.
struct Passage {
  bool through = false;                  ///< left the rig: met every mirror's outline, on its front, in order
  std::array<Eigen::Vector3d, 2> meets;  ///< where it met each mirror's plane, projector frame
  std::array<double, 2> slack{1, 1};     ///< MirrorPose::slack() there; a head has one mirror
  std::array<double, 2> cosine{1, 1};    ///< of the angle of incidence
  double length_m = 0;                   ///< from the projector's pupil to the last mirror
};

/// A panel pixel's light as it leaves the rig.
struct OutgoingRay {
  Eigen::Vector3d origin;     ///< on the last mirror
  Eigen::Vector3d direction;  ///< unit
  Passage passage;            ///< not through: origin and direction say where it would go with endless mirrors
};

/// What part of the panel lights a point, if nothing stands between.
struct LitBy {
  Eigen::Vector2d x;           ///< panel pixel; may lie outside the panel
  double distance_m = 0;       ///< along the light's way, from the pupil
  double off_axis_cosine = 1;  ///< at the projector's lens
  Eigen::Vector3d origin;      ///< last mirror's point, from which the light comes: the shadow ray's other end
  Passage passage;
};

class LightPath {
 public:
  /// `angles`: where the mirror truly stands.
  LightPath(const TrueRig& rig, hal::MirrorAngles angles);

  /// Forwards. `x` may lie between pixels and outside the panel. Nothing where the lens has no ray.
  std::optional<OutgoingRay> leave(const Eigen::Vector2d& x) const;

  /// Backwards: the point is reflected through the mirrors into the projector's frame (algorithms 4.1). Nothing when it
  /// would be behind the lens or beyond the lens's fold.
  std::optional<LitBy> lit_by(const Eigen::Vector3d& p_rig) const;
  /// The pixel alone, without asking where the light went: much cheaper.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& p_rig) const {
    return lens_.project(T_virtual_rig_ * p_rig);
  }

  /// The virtual projector: rig frame to the frame in which its lens is the projector's own. One mirror: det = -1.
  const Eigen::Isometry3d& T_virtual_rig() const { return T_virtual_rig_; }
  /// Its centre in the rig frame, from which light seems to come.
  Eigen::Vector3d centre() const { return -(T_virtual_rig_.linear().transpose() * T_virtual_rig_.translation()); }
  const std::array<MirrorPose, 2>& mirrors() const { return mirrors_; }

 private:
  Passage pass(Eigen::Vector3d direction) const;

  Lens lens_;
  int mirror_count_;
  std::array<MirrorPose, 2> mirrors_;  ///< projector frame
  Eigen::Isometry3d T_projector_rig_;
  Eigen::Isometry3d T_virtual_rig_;
};

}  // namespace raysteer::sim::optics
