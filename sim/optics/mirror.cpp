#include "sim/optics/mirror.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace raysteer::sim::optics {
namespace {

// A turn about a line through `point`.
struct Turn {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d point;

  Turn(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& on_axis)
      : rotation(Eigen::AngleAxisd(angle, axis).toRotationMatrix()), point(on_axis) {}
  Eigen::Vector3d move(const Eigen::Vector3d& p) const { return point + rotation * (p - point); }
};

MirrorPose at_rest(const MirrorPart& part) {
  MirrorPose pose;
  pose.centre = part.point + part.offset_m * part.normal;
  pose.plane.normal = part.normal;
  pose.along = (part.axis - part.axis.dot(part.normal) * part.normal).normalized();
  pose.across = pose.along.cross(part.normal);
  pose.half_size_m = part.half_size_m;
  pose.ellipse = part.ellipse;
  return pose;
}

void turn(MirrorPose& pose, const Turn& by) {
  pose.centre = by.move(pose.centre);
  pose.plane.normal = by.rotation * pose.plane.normal;
  pose.along = by.rotation * pose.along;
  pose.across = by.rotation * pose.across;
}

}  // namespace

double MirrorPose::slack(const Eigen::Vector3d& p) const {
  const Eigen::Vector3d from_centre = p - centre;
  const Eigen::Vector2d part(from_centre.dot(across) / half_size_m.x(), from_centre.dot(along) / half_size_m.y());
  return 1 - (ellipse ? part.norm() : part.cwiseAbs().maxCoeff());
}

std::array<MirrorPose, 2> TrueMirror::poses(hal::MirrorAngles angles) const {
  std::array<MirrorPose, 2> poses{at_rest(parts[0]), at_rest(parts[1])};
  if (head) {
    turn(poses[0], Turn(angles.axis2.raw(), parts[0].axis, parts[0].point));
    turn(poses[0], Turn(angles.axis1.raw(), outer_axis, outer_point));
  } else {
    turn(poses[0], Turn(angles.axis1.raw(), parts[0].axis, parts[0].point));
    turn(poses[1], Turn(angles.axis2.raw(), parts[1].axis, parts[1].point));
  }
  for (MirrorPose& pose : poses) {
    pose.plane.distance = pose.plane.normal.dot(pose.centre);
  }
  return poses;
}

}  // namespace raysteer::sim::optics
