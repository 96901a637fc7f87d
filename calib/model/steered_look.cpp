#include "calib/model/steered_look.hpp"

#include <Eigen/Geometry>
#include <cmath>

namespace raysteer::calib::model {
namespace {

constexpr int kAngle1 = 14;
constexpr int kAngle2 = 15;

/// A vector turned about a unit axis, and its derivatives (Rodrigues; the axis moves along its tangents).
struct Turned {
  Eigen::Vector3d v;
  Eigen::Matrix3d by_v;
  Eigen::Matrix<double, 3, 2> by_axis;
  Eigen::Vector3d by_angle;

  Turned(const Eigen::Vector3d& before, const Eigen::Vector3d& axis, double angle)
      : by_v(Eigen::AngleAxisd(angle, axis).toRotationMatrix()) {
    v = by_v * before;
    by_angle = axis.cross(v);
    const Eigen::Matrix<double, 3, 2> basis = tangents(axis);
    const double s = std::sin(angle);
    const double c1 = 1 - std::cos(angle);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d b = basis.col(k);
      by_axis.col(k) = s * b.cross(before) + c1 * (b.dot(before) * axis + axis.dot(before) * b);
    }
  }
};

}  // namespace

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12> by_lens(const Camera& camera,
                                                                         const Eigen::Vector2d& n) {
  const int count = coefficients(camera.lens);
  Eigen::Matrix<double, 2, Eigen::Dynamic, Eigen::ColMajor, 2, 12> by(2, 4 + count);
  const Eigen::Vector2d d = camera.distort(n);
  by.leftCols<4>() << d.x(), 0, 1, 0, 0, d.y(), 0, 1;
  const Eigen::Vector2d f(camera.fx, camera.fy);
  const double x = n.x();
  const double y = n.y();
  const double s = n.squaredNorm();
  const std::array<double, 8>& k = camera.k;
  const double b = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  const double g = (1 + s * (k[0] + s * (k[1] + s * k[4]))) / b;
  const Eigen::Vector2d radial = f.cwiseProduct(n) / b;
  by.col(4) = s * radial;
  by.col(5) = s * s * radial;
  by.col(6) = f.cwiseProduct(Eigen::Vector2d(2 * x * y, s + 2 * y * y));
  by.col(7) = f.cwiseProduct(Eigen::Vector2d(s + 2 * x * x, 2 * x * y));
  double power = s * s * s;
  if (count > 4) {
    by.col(8) = power * radial;
  }
  for (int i = 5; i < count; ++i) {
    by.col(4 + i) = -g * std::pow(s, i - 4) * radial;
  }
  return by;
}

// (4.2) with its derivatives: n = R(w, angle) n0, d = n.a + c.
SteeredLook::Plane SteeredLook::turned(const MirrorPart& part, double angle, int first, int point_first,
                                       int normal_first, int offset_at, int angle_at) {
  const Turned turn(part.normal, part.axis, angle);
  Plane plane;
  plane.normal = turn.v;
  plane.distance = turn.v.dot(part.point) + part.offset_m;
  plane.normal_by.middleCols<2>(first) = turn.by_axis;
  plane.normal_by.middleCols<2>(normal_first) = turn.by_v * tangents(part.normal);
  plane.normal_by.col(angle_at) = turn.by_angle;
  plane.distance_by = part.point.transpose() * plane.normal_by;
  plane.distance_by.middleCols<2>(point_first) += turn.v.transpose() * tangents(part.axis);
  plane.distance_by[offset_at] += 1;
  return plane;
}

// (4.3) with its derivatives: n = R(w1, angle) n', d = d' - n'.a1 + n.a1.
SteeredLook::Plane SteeredLook::carried(const Plane& inner, const Eigen::Vector3d& axis, const Eigen::Vector3d& point,
                                        double angle) {
  const Turned turn(inner.normal, axis, angle);
  Plane plane;
  plane.normal = turn.v;
  plane.distance = inner.distance + (turn.v - inner.normal).dot(point);
  plane.normal_by = turn.by_v * inner.normal_by;
  plane.normal_by.leftCols<2>() += turn.by_axis;
  plane.normal_by.col(kAngle1) += turn.by_angle;
  plane.distance_by = inner.distance_by + point.transpose() * (plane.normal_by - inner.normal_by);
  plane.distance_by.middleCols<2>(2) += (turn.v - inner.normal).transpose() * tangents(axis);
  return plane;
}

SteeredLook::SteeredLook(const SteeredProjector& projector, const Eigen::Vector2d& command_rad,
                         const Eigen::Vector2d& latent_rad)
    : kind_(projector.kind),
      T_projector_rig_(projector.T_projector_rig),
      R_projector_rig_(projector.T_projector_rig.rotation()),
      plane_count_(projector.kind == MirrorKind::kHead ? 1 : 2) {
  const Eigen::Vector2d angles = projector.angles(command_rad) + latent_rad;
  view_ = projector.at_angles(angles);
  if (kind_ == MirrorKind::kHead) {
    planes_[0] = carried(turned(projector.parts[0], angles.y(), 4, 6, 8, 10, kAngle2), projector.outer_axis,
                         projector.outer_point, angles.x());
  } else {
    planes_[0] = turned(projector.parts[1], angles.y(), 7, 9, 11, 13, kAngle2);
    planes_[1] = turned(projector.parts[0], angles.x(), 0, 2, 4, 6, kAngle1);
  }
  const Eigen::Vector2d u(command_rad.x() / projector.curves[0].half_range,
                          command_rad.y() / projector.curves[1].half_range);
  for (int i = 0; i < 2; ++i) {
    angles_by_curves_.row(i).segment<4>(4 * i) = projector.curves[static_cast<std::size_t>(i)].half_range *
                                                 Eigen::RowVector4d(u[i], u[i] * u[i], u[i] * u[i] * u[i], u[1 - i]);
  }
}

std::optional<Eigen::Vector2d> SteeredLook::project(const Eigen::Vector3d& p_rig, PixelDerivatives& by) const {
  const Eigen::Vector3d turned_point = R_projector_rig_ * p_rig;
  Eigen::Vector3d y = turned_point + T_projector_rig_.t;
  // S(X) = X - 2 (n.X - d) n: by X the Householder, by n -2 ((n.X - d) I + n X^T), by d 2 n.
  Eigen::Matrix3d by_start = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 16> by_mirror = Eigen::Matrix<double, 3, 16>::Zero();
  for (int k = 0; k < plane_count_; ++k) {
    const Plane& plane = planes_[static_cast<std::size_t>(k)];
    const double height = plane.normal.dot(y) - plane.distance;
    const Eigen::Matrix3d householder = Eigen::Matrix3d::Identity() - 2 * plane.normal * plane.normal.transpose();
    const Eigen::Matrix<double, 1, 16> height_by = y.transpose() * plane.normal_by - plane.distance_by;
    by_mirror = (householder * by_mirror).eval();
    by_mirror -= 2 * height * plane.normal_by + 2 * plane.normal * height_by;
    by_start = (householder * by_start).eval();
    y -= 2 * height * plane.normal;
  }
  Eigen::Matrix<double, 2, 3> by_y;
  const auto pixel = view_.lens.project(y, by_y);
  if (!pixel) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 2, 3> by_placed = by_y * by_start;
  by.by_point = by_placed * R_projector_rig_;
  const int mirror = mirror_parameters(kind_);
  by.by_parameters.resize(2, steered_parameters(kind_));
  by.by_parameters.leftCols<kLensParameters>() = by_lens(view_.lens, y.hnormalized()).leftCols<kLensParameters>();
  by.by_parameters.middleCols<3>(kLensParameters) = -by_placed * cross_matrix(turned_point);
  by.by_parameters.middleCols<3>(kLensParameters + 3) = by_placed;
  const Eigen::Matrix<double, 2, 16> pixel_by_mirror = by_y * by_mirror;
  by.by_parameters.middleCols(kLensParameters + kPoseParameters, mirror) = pixel_by_mirror.leftCols(mirror);
  by.by_angles = pixel_by_mirror.rightCols<2>();
  by.by_parameters.rightCols<kCurveParameters>() = by.by_angles * angles_by_curves_;
  return pixel;
}

}  // namespace raysteer::calib::model
