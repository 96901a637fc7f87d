#include "calib/solve/residual.hpp"

#include <cmath>

namespace raysteer::calib::solve {
namespace {

Eigen::Matrix3d cross(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

// Half extents and middle of the corners, metres.
struct Extent {
  double half_x, half_y;
  explicit Extent(const TargetSpec& target)
      : half_x(target.square_m * (target.corner_columns() - 1) / 2),
        half_y(target.square_m * (target.corner_rows() - 1) / 2) {}
};

// The surface's height at (x, y), its slope there, and what each sag contributes.
struct Surface {
  double z = 0;
  Eigen::Vector2d slope;
  Eigen::Vector2d by_sag;
  Surface(const Extent& extent, const Eigen::Vector2d& sag, double x, double y) {
    const double u = x / extent.half_x - 1;
    const double v = y / extent.half_y - 1;
    by_sag = {1 - u * u, 1 - v * v};
    slope = {-2 * sag.x() * u / extent.half_x, -2 * sag.y() * v / extent.half_y};
    z = sag.dot(by_sag);
  }
};

// d(distort)/d(k1 k2 p1 p2 k3 k4 k5 k6) at the undistorted n (2x8).
Eigen::Matrix<double, 2, 8> distort_by_k(const model::Camera& camera, const Eigen::Vector2d& n) {
  const auto& k = camera.k;
  const double x = n.x();
  const double y = n.y();
  const double s = n.squaredNorm();
  const double a = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  const double b = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  Eigen::Matrix<double, 2, 8> by_k;
  by_k.col(0) = n * (s / b);
  by_k.col(1) = n * (s * s / b);
  by_k.col(2) << 2 * x * y, s + 2 * y * y;
  by_k.col(3) << s + 2 * x * x, 2 * x * y;
  by_k.col(4) = n * (s * s * s / b);
  const double by_denominator = -a / (b * b);
  by_k.col(5) = n * (by_denominator * s);
  by_k.col(6) = n * (by_denominator * s * s);
  by_k.col(7) = n * (by_denominator * s * s * s);
  return by_k;
}

// Pixel of p (device frame) with all derivatives.
bool project(const model::Camera& camera, const Eigen::Vector3d& p, Eigen::Vector2d& q,
             Eigen::Matrix<double, 2, 3>* by_point, ByIntrinsics* by_intrinsics) {
  Eigen::Matrix<double, 2, 3> slope;
  const auto pixel = camera.project(p, slope);
  if (!pixel || !pixel->allFinite()) {
    return false;
  }
  q = *pixel;
  if (by_point != nullptr) {
    *by_point = slope;
  }
  if (by_intrinsics != nullptr) {
    const Eigen::Vector2d n(p.x() / p.z(), p.y() / p.z());
    by_intrinsics->setZero();
    (*by_intrinsics)(0, 0) = (q.x() - camera.cx) / camera.fx;
    (*by_intrinsics)(1, 1) = (q.y() - camera.cy) / camera.fy;
    (*by_intrinsics)(0, 2) = 1;
    (*by_intrinsics)(1, 3) = 1;
    const auto by_k = distort_by_k(camera, n);
    by_intrinsics->row(0).tail<8>() = camera.fx * by_k.row(0);
    by_intrinsics->row(1).tail<8>() = camera.fy * by_k.row(1);
  }
  return true;
}

}  // namespace

Eigen::Vector3d target_point(const TargetSpec& target, const Eigen::Vector2d& sag, int id,
                             Eigen::Matrix<double, 3, 2>* by_sag) {
  Eigen::Vector3d p = target::corner_position(target, id);
  const Surface surface(Extent(target), sag, p.x(), p.y());
  p.z() = surface.z;
  if (by_sag != nullptr) {
    by_sag->setZero();
    by_sag->row(2) = surface.by_sag.transpose();
  }
  return p;
}

bool corner_residual(const TargetSpec& target, const CornerMeasurement& corner, const model::Camera& camera,
                     const model::Pose& T_device_rig, const model::Pose& T_rig_target, const Eigen::Vector2d& sag,
                     Eigen::Vector2d& residual, CornerDerivatives* derivatives) {
  Eigen::Matrix<double, 3, 2> by_sag;
  const Eigen::Vector3d on_target = target_point(target, sag, corner.id, &by_sag);
  const Eigen::Vector3d turned = T_rig_target.q * on_target;
  const Eigen::Vector3d p_rig = turned + T_rig_target.t;
  const Eigen::Vector3d turned_rig = T_device_rig.q * p_rig;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Vector2d q;
  if (!project(camera, turned_rig + T_device_rig.t, q, &by_point,
               derivatives != nullptr ? &derivatives->by_intrinsics : nullptr)) {
    return false;
  }
  residual = q - corner.q;
  if (derivatives != nullptr) {
    derivatives->by_device.leftCols<3>() = -by_point * cross(turned_rig);
    derivatives->by_device.rightCols<3>() = by_point;
    const Eigen::Matrix<double, 2, 3> by_rig = by_point * T_device_rig.rotation();
    derivatives->by_view.leftCols<3>() = -by_rig * cross(turned);
    derivatives->by_view.rightCols<3>() = by_rig;
    derivatives->by_sag = by_rig * T_rig_target.rotation() * by_sag;
  }
  return true;
}

bool pixel_residual(const TargetSpec& target, const PixelMeasurement& pixel, const model::Camera& camera,
                    const model::Pose& T_camera_rig, const model::Camera& projector, const model::Pose& T_projector_rig,
                    const model::Pose& T_rig_target, const Eigen::Vector2d& sag, Eigen::Vector2d& residual,
                    PixelDerivatives* derivatives) {
  const auto n = camera.normalize(pixel.q);
  if (!n) {
    return false;
  }
  // Origin and direction of the ray, in the rig's frame and in the target's.
  const Eigen::Vector3d ray(n->x(), n->y(), 1);
  const Eigen::Matrix3d R_rig_camera = T_camera_rig.rotation().transpose();
  const Eigen::Vector3d centre = -(R_rig_camera * T_camera_rig.t);
  const Eigen::Vector3d direction = R_rig_camera * ray;
  const Eigen::Matrix3d R_target_rig = T_rig_target.rotation().transpose();
  const Eigen::Vector3d from_target = centre - T_rig_target.t;
  const Eigen::Vector3d o = R_target_rig * from_target;
  const Eigen::Vector3d e = R_target_rig * direction;
  if (std::abs(e.z()) < 1e-9) {
    return false;
  }
  // The sag is far smaller than the distance, so a few steps from the flat board reach rounding error.
  const Extent extent(target);
  double s = -o.z() / e.z();
  for (int step = 0; step < 6; ++step) {
    const Eigen::Vector3d b = o + s * e;
    const Surface surface(extent, sag, b.x(), b.y());
    const double by_s = e.z() - surface.slope.x() * e.x() - surface.slope.y() * e.y();
    s -= (b.z() - surface.z) / by_s;
  }
  if (!(s > 0)) {
    return false;
  }
  const Eigen::Vector3d b = o + s * e;
  const Eigen::Vector3d turned = T_rig_target.q * b;
  const Eigen::Vector3d p_rig = turned + T_rig_target.t;
  const Eigen::Vector3d turned_rig = T_projector_rig.q * p_rig;
  Eigen::Matrix<double, 2, 3> by_point;
  Eigen::Vector2d x;
  if (!project(projector, turned_rig + T_projector_rig.t, x, &by_point,
               derivatives != nullptr ? &derivatives->by_projector : nullptr)) {
    return false;
  }
  residual = x - pixel.x;
  if (derivatives == nullptr) {
    return true;
  }

  derivatives->by_projector_pose.leftCols<3>() = -by_point * cross(turned_rig);
  derivatives->by_projector_pose.rightCols<3>() = by_point;
  const Eigen::Matrix<double, 2, 3> by_rig = by_point * T_projector_rig.rotation();
  const Eigen::Matrix<double, 2, 3> by_b = by_rig * T_rig_target.rotation();

  // b slides along the ray so that it stays on the surface: db = (I - e g^T / (g e)) (do + s de) + e / (g e) dz,
  // with g the surface's normal (-dz/dx, -dz/dy, 1).
  const Surface surface(extent, sag, b.x(), b.y());
  const Eigen::Vector3d g(-surface.slope.x(), -surface.slope.y(), 1);
  const Eigen::Matrix3d slide = Eigen::Matrix3d::Identity() - e * g.transpose() / g.dot(e);
  const Eigen::Matrix<double, 2, 3> by_free = by_b * slide;  // by (do + s de)
  const Eigen::Matrix<double, 2, 3> by_free_rig = by_free * R_target_rig;

  // R'^T v = R^T v + R^T [v]x w for R' = exp([w]) R.
  const Eigen::Vector3d reach = from_target + s * direction;
  derivatives->by_view.leftCols<3>() = by_free_rig * cross(reach) - by_rig * cross(turned);
  derivatives->by_view.rightCols<3>() = by_rig - by_free_rig;
  derivatives->by_sag = by_b * e / g.dot(e) * surface.by_sag.transpose();

  const Eigen::Matrix<double, 2, 3> by_camera_frame = by_free_rig * R_rig_camera;
  derivatives->by_camera_pose.leftCols<3>() = by_camera_frame * cross(s * ray - T_camera_rig.t);
  derivatives->by_camera_pose.rightCols<3>() = -by_camera_frame;

  // distort(n, k) = ((q - c) / f): n follows when f, c or k change and q stays.
  Eigen::Matrix2d by_n;
  camera.distort(*n, by_n);
  const Eigen::Vector2d d((pixel.q.x() - camera.cx) / camera.fx, (pixel.q.y() - camera.cy) / camera.fy);
  ByIntrinsics right = ByIntrinsics::Zero();
  right(0, 0) = -d.x() / camera.fx;
  right(1, 1) = -d.y() / camera.fy;
  right(0, 2) = -1 / camera.fx;
  right(1, 3) = -1 / camera.fy;
  right.rightCols<8>() = -distort_by_k(camera, *n);
  derivatives->by_camera = s * by_camera_frame.leftCols<2>() * by_n.inverse() * right;
  return true;
}

std::array<double, kIntrinsics> intrinsics(const model::Camera& camera) {
  std::array<double, kIntrinsics> block{camera.fx, camera.fy, camera.cx, camera.cy};
  for (std::size_t i = 0; i < camera.k.size(); ++i) {
    block[4 + i] = camera.k[i];
  }
  return block;
}

void set_intrinsics(model::Camera& camera, const double* block) {
  camera.fx = block[0];
  camera.fy = block[1];
  camera.cx = block[2];
  camera.cy = block[3];
  for (std::size_t i = 0; i < camera.k.size(); ++i) {
    camera.k[i] = block[4 + i];
  }
}

}  // namespace raysteer::calib::solve
