#include "calib/bake/mirror_window.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace raysteer::calib::bake {

/// A mirror where it stands, projector frame.
struct MirrorWindow::Mirror {
  Eigen::Vector3d centre, normal, along, across;
  Eigen::Vector2d half_m;
  bool ellipse;

  explicit Mirror(const model::MirrorPart& part)
      : centre(part.point + part.offset_m * part.normal),
        normal(part.normal),
        along((part.axis - part.axis.dot(part.normal) * part.normal).normalized()),
        across(along.cross(part.normal)),
        half_m(0.5 * part.size_m),
        ellipse(part.ellipse) {}

  void turn(double angle, const Eigen::Vector3d& axis, const Eigen::Vector3d& point) {
    const Eigen::Matrix3d R = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    centre = point + R * (centre - point);
    normal = R * normal;
    along = R * along;
    across = R * across;
  }

  /// Of the rays origin + s D m.
  Meeting met_by(const Eigen::Vector3d& origin, const Eigen::Matrix3d& D) const {
    const Eigen::Vector3d from = origin - centre;
    Meeting meeting;
    meeting.front = -(D.transpose() * normal);
    meeting.inverse = D.transpose() * normal / -normal.dot(from);
    meeting.bounded = half_m.minCoeff() > 0;
    meeting.ellipse = ellipse;
    if (meeting.bounded) {
      meeting.across = (D.transpose() * across + across.dot(from) * meeting.inverse) / half_m.x();
      meeting.along = (D.transpose() * along + along.dot(from) * meeting.inverse) / half_m.y();
    }
    return meeting;
  }

  void reflect(Eigen::Vector3d& origin, Eigen::Matrix3d& D) const {
    origin -= 2 * normal.dot(origin - centre) * normal;
    D -= 2 * normal * (normal.transpose() * D);
  }
};

MirrorWindow::MirrorWindow(const model::SteeredProjector& projector, const Eigen::Vector2d& command_rad)
    : count_(projector.kind == model::MirrorKind::kHead ? 1 : 2) {
  const Eigen::Vector2d angles = projector.angles(command_rad);
  std::array<Mirror, 2> mirrors{Mirror(projector.parts[0]), Mirror(projector.parts[1])};
  if (count_ == 1) {
    mirrors[0].turn(angles.y(), projector.parts[0].axis, projector.parts[0].point);
    mirrors[0].turn(angles.x(), projector.outer_axis, projector.outer_point);
  } else {
    mirrors[0].turn(angles.x(), projector.parts[0].axis, projector.parts[0].point);
    mirrors[1].turn(angles.y(), projector.parts[1].axis, projector.parts[1].point);
  }
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Matrix3d D = Eigen::Matrix3d::Identity();
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    meets_[k] = mirrors[k].met_by(origin, D);
    mirrors[k].reflect(origin, D);
  }
  again_ = mirrors[0].met_by(origin, D);
}

bool MirrorWindow::Meeting::in_outline(const Eigen::Vector3d& m) const {
  if (!bounded) {
    return true;
  }
  const double limit = std::abs(inverse.dot(m));
  const double a = across.dot(m);
  const double b = along.dot(m);
  return ellipse ? a * a + b * b <= limit * limit : std::abs(a) <= limit && std::abs(b) <= limit;
}

bool MirrorWindow::passes(const Eigen::Vector3d& m) const {
  for (std::size_t k = 0; k < static_cast<std::size_t>(count_); ++k) {
    const double inverse = meets_[k].inverse.dot(m);
    if (!(inverse > 0) || !(meets_[k].front.dot(m) > 0) || !meets_[k].in_outline(m)) {
      return false;
    }
    if (k == 1 && !(inverse < meets_[0].inverse.dot(m))) {
      return false;  // the second mirror would be met before the first
    }
  }
  // A pair's first mirror must not stand in the way of what the second sends out.
  if (count_ == 2 && again_.bounded) {
    const double inverse = again_.inverse.dot(m);
    return !(inverse > 0 && inverse < meets_[1].inverse.dot(m) && again_.in_outline(m));
  }
  return true;
}

}  // namespace raysteer::calib::bake
