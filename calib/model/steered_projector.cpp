#include "calib/model/steered_projector.hpp"

#include <Eigen/Geometry>

namespace raysteer::calib::model {
namespace {

/// The plane normal.X = distance.
struct Plane {
  Eigen::Vector3d normal;
  double distance;
};

/// (4.2): the plane of a mirror turned about its own line.
Plane turned(const MirrorPart& part, double angle) {
  const Eigen::Vector3d normal = Eigen::AngleAxisd(angle, part.axis) * part.normal;
  return {normal, normal.dot(part.point) + part.offset_m};
}

/// (4.3): then carried about another line.
Plane carried(const Plane& plane, const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double angle) {
  const Eigen::Vector3d normal = Eigen::AngleAxisd(angle, axis) * plane.normal;
  return {normal, plane.distance - plane.normal.dot(point) + normal.dot(point)};
}

/// (4.1): light leaves by the last mirror, so the scene's points are reflected there first.
void reflect(VirtualProjector& view, const Plane& plane) {
  const Eigen::Matrix3d householder = Eigen::Matrix3d::Identity() - 2 * plane.normal * plane.normal.transpose();
  view.rotation = householder * view.rotation;
  view.translation = householder * view.translation + 2 * plane.distance * plane.normal;
}

}  // namespace

Eigen::Vector2d SteeredProjector::angles(const Eigen::Vector2d& command_rad) const {
  const Eigen::Vector2d u(command_rad.x() / curves[0].half_range, command_rad.y() / curves[1].half_range);
  Eigen::Vector2d angles;
  for (int i = 0; i < 2; ++i) {
    const CommandCurve& c = curves[static_cast<std::size_t>(i)];
    angles[i] = c.half_range * ((1 + c.gain) * u[i] + c.quadratic * u[i] * u[i] + c.cubic * u[i] * u[i] * u[i] +
                                c.cross_talk * u[1 - i]);
  }
  return angles;
}

VirtualProjector SteeredProjector::at_angles(const Eigen::Vector2d& angles_rad) const {
  VirtualProjector view{.lens = lens, .rotation = T_projector_rig.rotation(), .translation = T_projector_rig.t};
  if (kind == MirrorKind::kHead) {
    reflect(view, carried(turned(parts[0], angles_rad.y()), outer_axis, outer_point, angles_rad.x()));
  } else {
    reflect(view, turned(parts[1], angles_rad.y()));
    reflect(view, turned(parts[0], angles_rad.x()));
  }
  return view;
}

}  // namespace raysteer::calib::model
