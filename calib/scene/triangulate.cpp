#include "calib/scene/triangulate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "calib/scene/epipolar.hpp"

namespace raysteer::calib::scene {
namespace {

constexpr std::size_t kFewestPoints = 100;
/// A projector pixel is known exactly; a floor keeps the 2x2 inverses finite. px^2
constexpr double kVarianceFloor = 1e-6;

/// Covariance of a pixel carried to normalised coordinates.
Eigen::Matrix2d normalised(const model::Camera& camera, const Eigen::Vector2d& n, const Eigen::Matrix2d& covariance) {
  Eigen::Matrix2d by_n;
  camera.distort(n, by_n);
  by_n.row(0) *= camera.fx;
  by_n.row(1) *= camera.fy;
  const Eigen::Matrix2d inverse = by_n.inverse();
  return inverse * (covariance + kVarianceFloor * Eigen::Matrix2d::Identity()) * inverse.transpose();
}

/// Jacobian of (X/Z, Y/Z).
Eigen::Matrix<double, 2, 3> by_point(const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 3> j;
  j << 1 / p.z(), 0, -p.x() / (p.z() * p.z()), 0, 1 / p.z(), -p.y() / (p.z() * p.z());
  return j;
}

/// Moves both pixels the least, weighted by their covariances, onto the epipolar constraint (two Newton steps, after
/// P. Lindstrom, Triangulation Made Easy, CVPR 2010, with weights).
class Triangulator {
 public:
  explicit Triangulator(const TwoViews& views) : views_(views), R_(views.T_right_left.rotation()) {
    const Eigen::Vector3d& t = views.T_right_left.t;
    essential_ << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
    essential_ *= R_;
  }

  /// False where rays are parallel or meet behind a view.
  bool solve(const RayPair& ray, const Match& match, CloudPoint& point) const {
    const Eigen::Matrix2d cov_left = normalised(views_.left, ray.left, match.cov_left);
    const Eigen::Matrix2d cov_right = normalised(views_.right, ray.right, match.cov_right);
    Eigen::Vector2d a = ray.left;
    Eigen::Vector2d b = ray.right;
    for (int round = 0; round < 2; ++round) {
      // e(a, b) linearised at (a, b), moves measured from the measurement.
      const Eigen::Vector2d by_a = (essential_.transpose() * b.homogeneous()).head<2>();
      const Eigen::Vector2d by_b = (essential_ * a.homogeneous()).head<2>();
      const double e =
          b.homogeneous().dot(essential_ * a.homogeneous()) + by_a.dot(ray.left - a) + by_b.dot(ray.right - b);
      const double variance = by_a.dot(cov_left * by_a) + by_b.dot(cov_right * by_b);
      a = ray.left - cov_left * by_a * (e / variance);
      b = ray.right - cov_right * by_b * (e / variance);
    }
    // Rays meet now: depth from z (b x R a) = t x b.
    const Eigen::Vector3d right = b.homogeneous();
    const Eigen::Vector3d left_turned = R_ * a.homogeneous();
    const Eigen::Vector3d normal = right.cross(left_turned);
    const double z = normal.dot(views_.T_right_left.t.cross(right)) / normal.squaredNorm();
    const Eigen::Vector3d p = z * a.homogeneous();
    const Eigen::Vector3d p_right = views_.T_right_left * p;
    if (!(z > 0) || !(p_right.z() > 0) || !p.allFinite()) {
      return false;
    }
    const Eigen::Matrix<double, 2, 3> j_left = by_point(p);
    const Eigen::Matrix<double, 2, 3> j_right = by_point(p_right) * R_;
    const Eigen::Matrix3d information =
        j_left.transpose() * cov_left.inverse() * j_left + j_right.transpose() * cov_right.inverse() * j_right;
    point.p = p;
    point.covariance = information.inverse();
    return point.covariance.allFinite();
  }

 private:
  const TwoViews& views_;
  Eigen::Matrix3d R_;
  Eigen::Matrix3d essential_;
};

/// A point stays when two more of the 5 x 5 projector pixels around it lie within 1 % of its depth: real surfaces are
/// larger than a projector pixel, wrong matches seldom agree.
std::vector<CloudPoint> without_isolated(std::vector<CloudPoint> points, std::span<const Match> matches,
                                         std::size_t& isolated) {
  int columns = 0, rows = 0;
  for (const CloudPoint& point : points) {
    columns = std::max(columns, matches[point.match].i + 1);
    rows = std::max(rows, matches[point.match].j + 1);
  }
  Image<float> depth(columns + 4, rows + 4);  // a border, so that every pixel has all neighbours
  for (const CloudPoint& point : points) {
    depth(matches[point.match].i + 2, matches[point.match].j + 2) = static_cast<float>(point.p.z());
  }
  const auto alone = [&](const CloudPoint& point) {
    const int i = matches[point.match].i + 2;
    const int j = matches[point.match].j + 2;
    const float z = depth(i, j);
    int close = 0;
    for (int dj = -2; dj <= 2; ++dj) {
      for (int di = -2; di <= 2; ++di) {
        close += std::abs(depth(i + di, j + dj) - z) < 0.01F * z ? 1 : 0;
      }
    }
    return close < 3;  // itself and two more
  };
  isolated = std::erase_if(points, alone);
  return points;
}

}  // namespace

std::optional<CloudPoint> triangulate_one(const TwoViews& views, const Match& match, const RayPair& rays) {
  CloudPoint point;
  return Triangulator(views).solve(rays, match, point) ? std::optional(point) : std::nullopt;
}

Result<Cloud> triangulate(const TwoViews& views, std::span<const Match> matches, std::span<const RayPair> rays,
                          const TriangulateOptions& options) {
  RAYSTEER_CHECK(matches.size() == rays.size());
  const std::vector<double> disagreement = epipolar_disagreement(views, rays);
  const Triangulator triangulator(views);
  Cloud cloud;
  cloud.points.reserve(matches.size());
  for (std::uint32_t k = 0; k < matches.size(); ++k) {
    if (!(std::abs(disagreement[k]) < options.epipolar_gate_px)) {
      ++cloud.rejected.epipolar;
      continue;
    }
    CloudPoint point;
    if (!triangulator.solve(rays[k], matches[k], point) || point.p.z() > options.max_depth_m) {
      ++cloud.rejected.depth;
      continue;
    }
    point.match = k;
    cloud.points.push_back(point);
  }
  cloud.points = without_isolated(std::move(cloud.points), matches, cloud.rejected.isolated);
  if (cloud.points.size() < kFewestPoints) {
    return fail(RCode::kTooFewMatches,
                "of " + std::to_string(matches.size()) + " matches " + std::to_string(cloud.rejected.epipolar) +
                    " break the epipolar constraint and " + std::to_string(cloud.rejected.depth) +
                    " meet behind the cameras or too far away");
  }
  return cloud;
}

}  // namespace raysteer::calib::scene
