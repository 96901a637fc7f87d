// value: true mirrors: planes that turn about lines, with finite outlines. Frame: the projector's.
#pragma once

#include <Eigen/Core>
#include <array>

#include "hal/mirror.hpp"

namespace raysteer::sim::optics {

/// The plane n.X = d, |n| = 1.
struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance = 0;

  Eigen::Vector3d reflect_point(const Eigen::Vector3d& p) const { return p - 2 * (normal.dot(p) - distance) * normal; }
  Eigen::Vector3d reflect_direction(const Eigen::Vector3d& v) const { return v - 2 * normal.dot(v) * normal; }
};

/// One mirror as built: the line it turns about and what hangs on it at rest (algorithms 4.4).
struct MirrorPart {
  Eigen::Vector3d axis = Eigen::Vector3d::UnitY();     ///< unit
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     ///< on the axis, below the outline's centre
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitZ();  ///< at rest, unit, towards the light
  double offset_m = 0;                                 ///< of the reflecting surface from `point`, along the normal
  Eigen::Vector2d half_size_m{1, 1};                   ///< of the outline, across the axis and along it
  bool ellipse = true;                                 ///< outline: ellipse or rectangle
};

/// One mirror where it stands now.
struct MirrorPose {
  Plane plane;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();   ///< of the outline, on the surface
  Eigen::Vector3d across = Eigen::Vector3d::UnitX();  ///< unit, in the surface
  Eigen::Vector3d along = Eigen::Vector3d::UnitY();   ///< unit, in the surface: the axis, as far as it lies in it
  Eigen::Vector2d half_size_m{1, 1};
  bool ellipse = true;

  /// How far inside the outline a point of the surface is: 1 in the centre, 0 on the edge, negative outside.
  double slack(const Eigen::Vector3d& p) const;
};

/// A galvo pair: parts[0] is the mirror that light meets first, and each turns by its own angle (4.2).
/// A head: one mirror, parts[0], on the inner axis, which the outer axis carries (4.3).
struct TrueMirror {
  bool head = false;
  std::array<MirrorPart, 2> parts;
  Eigen::Vector3d outer_axis = Eigen::Vector3d::UnitZ();  ///< head only; unit
  Eigen::Vector3d outer_point = Eigen::Vector3d::Zero();  ///< head only

  int count() const { return head ? 1 : 2; }
  /// Where the mirrors stand; [1] is unused for a head. `angles` are true mechanical angles, not commands.
  std::array<MirrorPose, 2> poses(hal::MirrorAngles angles) const;
};

}  // namespace raysteer::sim::optics
