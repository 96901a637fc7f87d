#include "calib/solve/closed_form.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace raysteer::calib::solve {
namespace {

// Moves points to mean 0 and mean distance sqrt(D): the transform and its application.
template <int kDim>
struct Normaliser {
  using Vector = Eigen::Matrix<double, kDim, 1>;
  Vector mean = Vector::Zero();
  double scale = 1;
  explicit Normaliser(std::span<const Vector> points) {
    for (const Vector& p : points) {
      mean += p;
    }
    mean /= static_cast<double>(points.size());
    double distance = 0;
    for (const Vector& p : points) {
      distance += (p - mean).norm();
    }
    distance /= static_cast<double>(points.size());
    scale = distance > 0 ? std::sqrt(static_cast<double>(kDim)) / distance : 1;
  }
  Vector operator()(const Vector& p) const { return scale * (p - mean); }
  Eigen::Matrix<double, kDim + 1, kDim + 1> matrix() const {
    Eigen::Matrix<double, kDim + 1, kDim + 1> m = Eigen::Matrix<double, kDim + 1, kDim + 1>::Identity();
    m.template topLeftCorner<kDim, kDim>() *= scale;
    m.template topRightCorner<kDim, 1>() = -scale * mean;
    return m;
  }
};

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  if (R.determinant() < 0) {
    Eigen::Matrix3d U = svd.matrixU();
    U.col(2) *= -1;
    R = U * svd.matrixV().transpose();
  }
  return R;
}

double middle(std::vector<double> values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

std::optional<Eigen::Matrix3d> homography(std::span<const Eigen::Vector2d> on_plane,
                                          std::span<const Eigen::Vector2d> on_image) {
  if (on_plane.size() < 4 || on_plane.size() != on_image.size()) {
    return std::nullopt;
  }
  const Normaliser<2> plane(on_plane);
  const Normaliser<2> image(on_image);
  Eigen::Matrix<double, 9, 9> normal = Eigen::Matrix<double, 9, 9>::Zero();
  for (std::size_t i = 0; i < on_plane.size(); ++i) {
    const Eigen::Vector3d p = plane(on_plane[i]).homogeneous();
    const Eigen::Vector2d q = image(on_image[i]);
    Eigen::Matrix<double, 2, 9> row;
    row << p.transpose(), Eigen::RowVector3d::Zero(), -q.x() * p.transpose(),  //
        Eigen::RowVector3d::Zero(), p.transpose(), -q.y() * p.transpose();
    normal += row.transpose() * row;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 9, 9>> eigen(normal);
  if (eigen.info() != Eigen::Success || eigen.eigenvalues()[1] < 1e-12 * eigen.eigenvalues()[8]) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 9, 1> h = eigen.eigenvectors().col(0);
  Eigen::Matrix3d H;
  H << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  H = image.matrix().inverse() * H * plane.matrix();
  // Points of the plane lie before the device: the third coordinate is positive.
  if ((H * on_plane[0].homogeneous()).z() < 0) {
    H = -H;
  }
  return H / H.norm();
}

std::optional<double> focal_length(std::span<const Eigen::Matrix3d> homographies, const Eigen::Vector2d& centre) {
  // With w = diag(u, u, 1), u = 1/f^2:  h1^T w h2 = 0  and  h1^T w h1 = h2^T w h2.
  double ata = 0;
  double atb = 0;
  for (Eigen::Matrix3d H : homographies) {
    H.row(0) -= centre.x() * H.row(2);
    H.row(1) -= centre.y() * H.row(2);
    // Equal say for every view, whatever its scale.
    const double scale = H.col(0).head<2>().norm() * H.col(1).head<2>().norm();
    if (!(scale > 0)) {
      continue;
    }
    const Eigen::Vector2d a = H.col(0).head<2>();
    const Eigen::Vector2d b = H.col(1).head<2>();
    const double c = H(2, 0);
    const double d = H(2, 1);
    for (const auto& [left, right] :
         {std::pair{a.dot(b) / scale, -c * d / scale},
          std::pair{(a.squaredNorm() - b.squaredNorm()) / scale, -(c * c - d * d) / scale}}) {
      ata += left * left;
      atb += left * right;
    }
  }
  const double u = atb / ata;
  if (!std::isfinite(u) || u <= 0) {
    return std::nullopt;
  }
  return 1 / std::sqrt(u);
}

model::Pose plane_pose(const Eigen::Matrix3d& homography, double focal, const Eigen::Vector2d& centre) {
  Eigen::Matrix3d M = homography;
  M.row(0) = (M.row(0) - centre.x() * homography.row(2)) / focal;
  M.row(1) = (M.row(1) - centre.y() * homography.row(2)) / focal;
  const double scale = 2 / (M.col(0).norm() + M.col(1).norm());
  M *= M(2, 2) < 0 ? -scale : scale;
  Eigen::Matrix3d R;
  R << M.col(0), M.col(1), M.col(0).cross(M.col(1));
  return {Eigen::Quaterniond(nearest_rotation(R)), M.col(2)};
}

std::optional<Resection> resection(std::span<const Eigen::Vector3d> points, std::span<const Eigen::Vector2d> pixels) {
  if (points.size() < 6 || points.size() != pixels.size()) {
    return std::nullopt;
  }
  const Normaliser<3> space(points);
  const Normaliser<2> image(pixels);
  Eigen::Matrix<double, 12, 12> normal = Eigen::Matrix<double, 12, 12>::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector4d p = space(points[i]).homogeneous();
    const Eigen::Vector2d q = image(pixels[i]);
    Eigen::Matrix<double, 2, 12> row;
    row << p.transpose(), Eigen::RowVector4d::Zero(), -q.x() * p.transpose(),  //
        Eigen::RowVector4d::Zero(), p.transpose(), -q.y() * p.transpose();
    normal += row.transpose() * row;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>> eigen(normal);
  if (eigen.info() != Eigen::Success || eigen.eigenvalues()[1] < 1e-12 * eigen.eigenvalues()[11]) {
    return std::nullopt;
  }
  const Eigen::Matrix<double, 12, 1> h = eigen.eigenvectors().col(0);
  Eigen::Matrix<double, 3, 4> P;
  P << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8], h[9], h[10], h[11];
  P = image.matrix().inverse() * P * space.matrix();
  P /= P.block<1, 3>(2, 0).norm();
  if ((P * points[0].homogeneous()).z() < 0) {
    P = -P;  // points lie before the device
  }
  Resection result;
  result.mirrored = P.leftCols<3>().determinant() < 0;
  // P = K [R t]: rows of R from the bottom up (RQ by Gram and Schmidt).
  const Eigen::Vector3d r3 = P.block<1, 3>(2, 0).transpose();
  const Eigen::Vector3d m2 = P.block<1, 3>(1, 0).transpose();
  const Eigen::Vector3d m1 = P.block<1, 3>(0, 0).transpose();
  result.cy = m2.dot(r3);
  result.fy = (m2 - result.cy * r3).norm();
  const Eigen::Vector3d r2 = (m2 - result.cy * r3) / result.fy;
  result.cx = m1.dot(r3);
  const double skew = m1.dot(r2);
  result.fx = (m1 - result.cx * r3 - skew * r2).norm();
  Eigen::Matrix3d R;
  R.row(2) = r3.transpose();
  R.row(1) = r2.transpose();
  R.row(0) = r2.cross(r3).transpose();
  if (!(result.fx > 0) || !(result.fy > 0) || !R.allFinite()) {
    return std::nullopt;
  }
  result.T_device_world.q = Eigen::Quaterniond(nearest_rotation(R));
  const Eigen::Vector3d p4 = P.col(3);
  const double tz = p4.z();
  const double ty = (p4.y() - result.cy * tz) / result.fy;
  const double tx = (p4.x() - result.cx * tz - skew * ty) / result.fx;
  result.T_device_world.t = {tx, ty, tz};
  return result;
}

model::Pose median_pose(std::span<const model::Pose> poses) {
  // The tangent plane of the pose with the smallest sum of angles to the others, so that one odd pose does not choose.
  std::size_t centre = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    double sum = 0;
    for (const model::Pose& other : poses) {
      sum += std::min(0.3, poses[i].q.angularDistance(other.q));
    }
    if (sum < smallest) {
      smallest = sum;
      centre = i;
    }
  }
  std::array<std::vector<double>, 6> numbers;
  for (const model::Pose& pose : poses) {
    const Eigen::AngleAxisd turn(pose.q * poses[centre].q.conjugate());
    const Eigen::Vector3d w = turn.angle() * turn.axis();
    for (std::size_t i = 0; i < 3; ++i) {
      numbers[i].push_back(w[static_cast<Eigen::Index>(i)]);
      numbers[i + 3].push_back(pose.t[static_cast<Eigen::Index>(i)]);
    }
  }
  const Eigen::Vector3d w(middle(numbers[0]), middle(numbers[1]), middle(numbers[2]));
  return {model::rotation_by(w) * poses[centre].q, {middle(numbers[3]), middle(numbers[4]), middle(numbers[5])}};
}

}  // namespace raysteer::calib::solve
