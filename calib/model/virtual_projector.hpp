// value: the projector as the scene sees it in its mirrors: for one look, an ordinary projector standing elsewhere.
//
// Every mirror reflects the pose (algorithms 4.2). After an odd number of them `rotation` has determinant -1 and the
// picture is flipped; nothing here needs to know.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/model/camera.hpp"

namespace raysteer::calib::model {

struct VirtualProjector {
  Camera lens;
  /// A rig-frame point p is at rotation * p + translation in the lens's frame.
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  /// The panel pixel that lights a point of the rig's frame, inside the panel or not. No value behind the lens.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_rig) const {
    return lens.project(rotation * p_rig + translation);
  }
  /// Where the light seems to come from, rig frame.
  Eigen::Vector3d centre() const { return -(rotation.transpose() * translation); }
  /// Unit direction of a panel pixel's light, rig frame. No value where the lens cannot be undone.
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& x) const {
    const auto n = lens.normalize(x);
    if (!n) {
      return std::nullopt;
    }
    return rotation.transpose() * n->homogeneous().normalized();
  }
  bool mirrored() const { return rotation.determinant() < 0; }
};

}  // namespace raysteer::calib::model
