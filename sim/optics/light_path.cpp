#include "sim/optics/light_path.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::sim::optics {
namespace {

// The reflection in a plane as a transform; its linear part has determinant -1.
Eigen::Isometry3d reflection(const Plane& plane) {
  Eigen::Isometry3d S = Eigen::Isometry3d::Identity();
  S.linear() -= 2 * plane.normal * plane.normal.transpose();
  S.translation() = 2 * plane.distance * plane.normal;
  return S;
}

struct Bounce {
  double length = 0;
  double cosine = 0;
};

// Where a ray meets an endless mirror; negative length or cosine: behind it, or on the mirror's back.
Bounce meet(const Plane& plane, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const double cosine = -plane.normal.dot(direction);
  return {.length = (plane.normal.dot(origin) - plane.distance) / cosine, .cosine = cosine};
}

}  // namespace

LightPath::LightPath(const TrueRig& rig, hal::MirrorAngles angles)
    : lens_(rig.projector.lens),
      mirror_count_(rig.mirror.count()),
      mirrors_(rig.mirror.poses(angles)),
      T_projector_rig_(rig.projector.T_projector_rig) {
  // Unfolded from the scene, last mirror first: Y = S1(S2(T X)).
  T_virtual_rig_ = T_projector_rig_;
  for (int k = mirror_count_; k-- > 0;) {
    T_virtual_rig_ = reflection(mirrors_[k].plane) * T_virtual_rig_;
  }
}

Passage LightPath::pass(Eigen::Vector3d direction) const {
  Passage passage;
  passage.through = true;
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int k = 0; k < mirror_count_; ++k) {
    const MirrorPose& mirror = mirrors_[k];
    const auto [length, cosine] = meet(mirror.plane, at, direction);
    at += length * direction;
    passage.length_m += length;
    passage.meets[k] = at;
    passage.cosine[k] = cosine;
    passage.slack[k] = mirror.slack(at);
    passage.through = passage.through && length > 0 && cosine > 0 && passage.slack[k] >= 0;
    direction = mirror.plane.reflect_direction(direction);
  }
  // A galvo's first mirror must not stand in the way of what the second sends out.
  if (mirror_count_ == 2 && passage.through) {
    const auto [length, cosine] = meet(mirrors_[0].plane, at, direction);
    passage.through = !(length > 0 && mirrors_[0].slack(at + length * direction) >= 0);
  }
  return passage;
}

std::optional<OutgoingRay> LightPath::leave(const Eigen::Vector2d& x) const {
  const Eigen::Vector3d direction = lens_.ray(x);
  if (!direction.allFinite()) {
    return {};
  }
  const Passage passage = pass(direction);
  const Eigen::Matrix3d R_rig_projector = T_projector_rig_.linear().transpose();
  const Eigen::Vector3d& last = passage.meets[static_cast<std::size_t>(mirror_count_ - 1)];
  return OutgoingRay{.origin = R_rig_projector * (last - T_projector_rig_.translation()),
                     .direction = T_virtual_rig_.linear().transpose() * direction,
                     .passage = passage};
}

std::optional<LitBy> LightPath::lit_by(const Eigen::Vector3d& p_rig) const {
  const Eigen::Vector3d unfolded = T_virtual_rig_ * p_rig;
  const std::optional<Eigen::Vector2d> x = lens_.project(unfolded);
  if (!x) {
    return {};
  }
  const double distance = unfolded.norm();
  const Eigen::Vector3d direction = unfolded / distance;
  Passage passage = pass(direction);
  // A point between the lens and the mirrors, or behind the last mirror, is lit by nobody.
  passage.through = passage.through && distance > passage.length_m;
  const Eigen::Vector3d& last = passage.meets[static_cast<std::size_t>(mirror_count_ - 1)];
  return LitBy{.x = *x,
               .distance_m = distance,
               .off_axis_cosine = direction.z(),
               .origin = T_projector_rig_.linear().transpose() * (last - T_projector_rig_.translation()),
               .passage = passage};
}

}  // namespace raysteer::sim::optics
