#include "calib/model/camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace raysteer::calib::model {
namespace {

constexpr double kNearestDepth = 1e-9;  // metres; closer counts as behind the camera

// d(r_d)/dr of the radial part: (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6).
double radial_slope(const std::array<double, 8>& k, double r) {
  const double s = r * r;
  const double a = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  const double b = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  const double da = k[0] + s * (2 * k[1] + s * 3 * k[4]);
  const double db = k[5] + s * (2 * k[6] + s * 3 * k[7]);
  return a / b + 2 * s * (da * b - a * db) / (b * b);
}

}  // namespace

std::string_view to_string(LensModel lens) {
  switch (lens) {
    case LensModel::kBc4:
      return "bc4";
    case LensModel::kBc5:
      return "bc5";
    case LensModel::kBc8:
      return "bc8";
  }
  return "bc4";
}

std::optional<LensModel> lens_from_string(std::string_view text) {
  for (const LensModel lens : {LensModel::kBc4, LensModel::kBc5, LensModel::kBc8}) {
    if (text == to_string(lens)) {
      return lens;
    }
  }
  return std::nullopt;
}

int coefficients(LensModel lens) {
  switch (lens) {
    case LensModel::kBc4:
      return 4;
    case LensModel::kBc5:
      return 5;
    case LensModel::kBc8:
      return 8;
  }
  return 4;
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& n) const {
  Eigen::Matrix2d by_n;
  return distort(n, by_n);
}

Eigen::Vector2d Camera::distort(const Eigen::Vector2d& n, Eigen::Matrix2d& by_n) const {
  const double x = n.x();
  const double y = n.y();
  const double s = n.squaredNorm();
  const double a = 1 + s * (k[0] + s * (k[1] + s * k[4]));
  const double b = 1 + s * (k[5] + s * (k[6] + s * k[7]));
  const double da = k[0] + s * (2 * k[1] + s * 3 * k[4]);
  const double db = k[5] + s * (2 * k[6] + s * 3 * k[7]);
  const double g = a / b;
  const double dg = (da - g * db) / b;  // by s
  const double p1 = k[2];
  const double p2 = k[3];
  by_n << g + 2 * x * x * dg + 2 * p1 * y + 6 * p2 * x, 2 * x * y * dg + 2 * p1 * x + 2 * p2 * y,
      2 * x * y * dg + 2 * p1 * x + 2 * p2 * y, g + 2 * y * y * dg + 6 * p1 * y + 2 * p2 * x;
  return {x * g + 2 * p1 * x * y + p2 * (s + 2 * x * x), y * g + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& p) const {
  Eigen::Matrix<double, 2, 3> by_point;
  return project(p, by_point);
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& p, Eigen::Matrix<double, 2, 3>& by_point) const {
  if (!(p.z() > kNearestDepth)) {
    return std::nullopt;
  }
  const Eigen::Vector2d n(p.x() / p.z(), p.y() / p.z());
  Eigen::Matrix2d by_n;
  const Eigen::Vector2d d = distort(n, by_n);
  by_n.row(0) *= fx / p.z();
  by_n.row(1) *= fy / p.z();
  by_point.leftCols<2>() = by_n;
  by_point.col(2) = -by_n * n;
  return Eigen::Vector2d(fx * d.x() + cx, fy * d.y() + cy);
}

std::optional<Eigen::Vector2d> Camera::normalize(const Eigen::Vector2d& q) const {
  const Eigen::Vector2d d((q.x() - cx) / fx, (q.y() - cy) / fy);
  if (!d.allFinite()) {
    return std::nullopt;
  }
  Eigen::Vector2d n = d;
  double miss = (distort(n) - d).norm();
  for (int iteration = 0; iteration < 30 && miss > 1e-15; ++iteration) {
    Eigen::Matrix2d by_n;
    const Eigen::Vector2d error = distort(n, by_n) - d;
    if (!(by_n.determinant() > 0)) {
      return std::nullopt;  // beyond the radius up to which the lens model is one to one
    }
    const Eigen::Vector2d full = by_n.inverse() * error;
    // Newton with halving: far out the full step can leave the valid radius.
    double step = 1;
    Eigen::Vector2d next = n - full;
    double next_miss = (distort(next) - d).norm();
    while (!(next_miss < miss) && step > 1e-3) {
      step /= 2;
      next = n - step * full;
      next_miss = (distort(next) - d).norm();
    }
    if (!(next_miss < miss)) {
      break;
    }
    n = next;
    miss = next_miss;
  }
  if (!(miss < 1e-12 * std::max(1.0, d.norm()))) {
    return std::nullopt;
  }
  return n;
}

bool Camera::is_monotonic() const {
  // The image's corners give distorted radii, the slope is by undistorted ones: walk outwards until the distorted
  // radius has passed the farthest corner.
  double farthest = 0;
  for (const double x : {-0.5, width - 0.5}) {
    for (const double y : {-0.5, height - 0.5}) {
      farthest = std::max(farthest, std::hypot((x - cx) / fx, (y - cy) / fy));
    }
  }
  const double reach = 1.1 * farthest;
  constexpr int kRadii = 64;
  double r = 0;
  for (double r_d = 0; r_d < reach; r += reach / kRadii) {
    if (!(radial_slope(k, r) > 0)) {
      return false;
    }
    r_d += radial_slope(k, r) * reach / kRadii;
  }
  return true;
}

Status check(const Camera& camera) {
  const auto finite = [](double value) { return std::isfinite(value); };
  if (!finite(camera.fx) || !finite(camera.fy) || !finite(camera.cx) || !finite(camera.cy) ||
      !std::ranges::all_of(camera.k, finite)) {
    return fail(RCode::kNotFinite, "focal length, principal point and distortion must be finite numbers");
  }
  if (camera.width <= 0 || camera.height <= 0) {
    return fail(RCode::kBadValue, "width and height must be positive");
  }
  if (camera.fx <= 0 || camera.fy <= 0) {
    return fail(RCode::kBadValue, "focal lengths must be positive");
  }
  return ok();
}

}  // namespace raysteer::calib::model
