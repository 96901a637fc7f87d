#include "sim/optics/lens.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace raysteer::sim::optics {
namespace {

// Bends an undistorted point (x/z, y/z), and gives the Jacobian where one is asked for.
Eigen::Vector2d bend(const std::array<double, 5>& k, const Eigen::Vector2d& u, Eigen::Matrix2d* slope = nullptr) {
  const auto [k1, k2, p1, p2, k3] = k;
  const double x = u.x();
  const double y = u.y();
  const double s = x * x + y * y;
  const double radial = 1 + s * (k1 + s * (k2 + s * k3));
  if (slope != nullptr) {
    const double by_s = k1 + s * (2 * k2 + s * 3 * k3);
    const double mixed = 2 * x * y * by_s + 2 * p1 * x + 2 * p2 * y;
    *slope << radial + 2 * x * x * by_s + 2 * p1 * y + 6 * p2 * x, mixed, mixed,
        radial + 2 * y * y * by_s + 6 * p1 * y + 2 * p2 * x;
  }
  return {x * radial + 2 * p1 * x * y + p2 * (s + 2 * x * x), y * radial + p1 * (s + 2 * y * y) + 2 * p2 * x * y};
}

// The first s = r^2 > 0 at which r (1 + k1 s + k2 s^2 + k3 s^3) stops growing; infinity when it never does.
double fold(const std::array<double, 5>& k) {
  const auto growth = [&](double s) { return 1 + s * (3 * k[0] + s * (5 * k[1] + s * 7 * k[4])); };
  constexpr double kStep = 0.02;
  constexpr double kFarthest = 50;  // 82 degrees off the axis: no picture of ours goes there
  for (double s = kStep; s < kFarthest; s += kStep) {
    if (growth(s) <= 0) {
      double inside = s - kStep;
      double outside = s;
      for (int i = 0; i < 50; ++i) {
        const double middle = (inside + outside) / 2;
        (growth(middle) > 0 ? inside : outside) = middle;
      }
      return inside;
    }
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

Lens::Lens(const LensNumbers& numbers) : numbers_(numbers), widest_squared_(fold(numbers.distortion)) {}

std::optional<Eigen::Vector2d> Lens::project(const Eigen::Vector3d& p) const {
  if (!(p.z() > 0)) {
    return {};
  }
  const Eigen::Vector2d u = p.head<2>() / p.z();
  if (!(u.squaredNorm() < widest_squared_)) {
    return {};
  }
  return numbers_.centre_px + numbers_.focal_px.cwiseProduct(bend(numbers_.distortion, u));
}

Eigen::Vector3d Lens::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d wanted = (pixel - numbers_.centre_px).cwiseQuotient(numbers_.focal_px);
  Eigen::Vector2d u = wanted;
  // Newton doubles the right digits each time; a few steps more than needed cost less than a wrong ray.
  constexpr int kMostSteps = 30;
  double residual = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMostSteps; ++i) {
    Eigen::Matrix2d slope;
    const Eigen::Vector2d error = bend(numbers_.distortion, u, &slope) - wanted;
    const double now = error.squaredNorm();
    if (now == 0 || (now >= residual && now < 1e-28)) {
      break;
    }
    residual = now;
    u -= slope.inverse() * error;
  }
  residual = (bend(numbers_.distortion, u) - wanted).squaredNorm();
  if (!(residual < 1e-24) || !(u.squaredNorm() < widest_squared_)) {
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  return u.homogeneous().normalized();
}

bool Lens::covers(int width, int height) const {
  // The widest pixels lie on the border; every eighth of it is close enough together to meet a fold.
  const auto has_ray = [&](double x, double y) { return ray({x, y}).allFinite(); };
  constexpr int kParts = 64;
  for (int i = 0; i <= kParts; ++i) {
    const double x = -0.5 + width * static_cast<double>(i) / kParts;
    const double y = -0.5 + height * static_cast<double>(i) / kParts;
    if (!has_ray(x, -0.5) || !has_ray(x, height - 0.5) || !has_ray(-0.5, y) || !has_ray(width - 0.5, y)) {
      return false;
    }
  }
  return true;
}

}  // namespace raysteer::sim::optics
