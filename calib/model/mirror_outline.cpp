#include "calib/model/mirror_outline.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace raysteer::calib::model {

double MirrorOutlines::Part::slack(const Eigen::Vector3d& p) const {
  if (!(half_size_m.minCoeff() > 0)) {
    return 1;
  }
  const Eigen::Vector3d from_centre = p - centre;
  const Eigen::Vector2d part(from_centre.dot(across) / half_size_m.x(), from_centre.dot(along) / half_size_m.y());
  return 1 - (ellipse ? part.norm() : part.cwiseAbs().maxCoeff());
}

void MirrorOutlines::Part::turn(const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double angle) {
  const Eigen::AngleAxisd by(angle, axis);
  normal = by * normal;
  across = by * across;
  along = by * along;
  centre = point + by * (centre - point);
}

MirrorOutlines::Part MirrorOutlines::at_rest(const MirrorPart& part) {
  const Eigen::Vector3d along = (part.axis - part.axis.dot(part.normal) * part.normal).normalized();
  return {.normal = part.normal,
          .centre = part.point + part.offset_m * part.normal,
          .across = along.cross(part.normal),
          .along = along,
          .half_size_m = part.size_m / 2,
          .ellipse = part.ellipse};
}

MirrorOutlines::MirrorOutlines(const SteeredProjector& projector, const Eigen::Vector2d& angles_rad)
    : lens_(projector.lens),
      parts_{at_rest(projector.parts[0]), at_rest(projector.parts[1])},
      count_(projector.kind == MirrorKind::kHead ? 1 : 2) {
  if (projector.kind == MirrorKind::kHead) {
    parts_[0].turn(projector.parts[0].axis, projector.parts[0].point, angles_rad.y());
    parts_[0].turn(projector.outer_axis, projector.outer_point, angles_rad.x());
  } else {
    parts_[0].turn(projector.parts[0].axis, projector.parts[0].point, angles_rad.x());
    parts_[1].turn(projector.parts[1].axis, projector.parts[1].point, angles_rad.y());
  }
}

double MirrorOutlines::slack(const Eigen::Vector2d& x) const {
  const auto n = lens_.normalize(x);
  if (!n) {
    return -1;
  }
  Eigen::Vector3d direction = n->homogeneous().normalized();
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  double least = 1;
  for (int k = 0; k < count_; ++k) {
    const Part& part = parts_[static_cast<std::size_t>(k)];
    const double cosine = -part.normal.dot(direction);
    const double length = part.normal.dot(at - part.centre) / cosine;
    if (!(cosine > 0 && length > 0)) {
      return -1;
    }
    at += length * direction;
    direction += 2 * cosine * part.normal;
    least = std::min(least, part.slack(at));
  }
  if (count_ == 2 && least >= 0 && parts_[0].half_size_m.minCoeff() > 0) {
    const double cosine = -parts_[0].normal.dot(direction);
    const double length = parts_[0].normal.dot(at - parts_[0].centre) / cosine;
    if (length > 0 && parts_[0].slack(at + length * direction) >= 0) {
      return -1;
    }
  }
  return least;
}

double MirrorOutlines::passing_part(int columns, int rows) const {
  int passing = 0;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      passing += passes({(i + 0.5) * lens_.width / columns - 0.5, (j + 0.5) * lens_.height / rows - 0.5}) ? 1 : 0;
    }
  }
  return static_cast<double>(passing) / (columns * rows);
}

}  // namespace raysteer::calib::model
