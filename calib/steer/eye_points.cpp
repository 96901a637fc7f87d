#include "calib/steer/eye_points.hpp"

#include <array>
#include <cmath>

#include "calib/model/steered_look.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr double kFarthest = 1000;  // metres

/// Where two rays from `from` pass each other most closely.
std::optional<Eigen::Vector3d> middle(const std::array<Eigen::Vector3d, 2>& from,
                                      const std::array<Eigen::Vector3d, 2>& along) {
  const Eigen::Vector3d apart = from[1] - from[0];
  const double c = along[0].dot(along[1]);
  const double sine2 = 1 - c * c;
  if (!(sine2 > 1e-10)) {
    return std::nullopt;
  }
  const double a = (apart.dot(along[0]) - c * apart.dot(along[1])) / sine2;
  const double b = (c * apart.dot(along[0]) - apart.dot(along[1])) / sine2;
  if (!(a > 0) || !(b > 0) || a > kFarthest) {
    return std::nullopt;
  }
  return (from[0] + a * along[0] + from[1] + b * along[1]) / 2;
}

/// W with W^T W = covariance^-1.
Eigen::Matrix2d whitening(const Eigen::Matrix2d& covariance) {
  return Eigen::Matrix2d(covariance.inverse()).llt().matrixU();
}

}  // namespace

Eigen::MatrixXd camera_prior(const model::Rig& cameras) {
  // Scaled to a correlation matrix first: focal lengths in pixels and angles in radians differ by 10^6.
  const Eigen::VectorXd sigma = cameras.covariance.diagonal().cwiseMax(0).cwiseSqrt();
  const Eigen::VectorXd inverse = (sigma.array() > 0).select(1 / sigma.array().max(1e-300), 0);
  const Eigen::MatrixXd correlation = inverse.asDiagonal() * cameras.covariance * inverse.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen((correlation + correlation.transpose()) / 2);
  const Eigen::Index n = correlation.rows();
  Eigen::Index kept = 0;
  while (kept < n && eigen.eigenvalues()[n - 1 - kept] > 1e-12) {
    ++kept;
  }
  return sigma.asDiagonal() * eigen.eigenvectors().rightCols(kept) *
         eigen.eigenvalues().tail(kept).cwiseSqrt().asDiagonal();
}

model::Rig moved_cameras(const model::Rig& cameras, const Eigen::VectorXd& delta) {
  model::Rig moved = cameras;
  for (std::size_t i = 0; i < moved.devices.size(); ++i) {
    moved.devices[i] = model::perturbed(cameras.devices[i], delta.segment(cameras.offset(i), cameras.count(i)), i > 0);
  }
  return moved;
}

std::optional<EyePoint> Eyes::see(const LitPoint& point) const {
  std::array<Eigen::Vector3d, 2> from;
  std::array<Eigen::Vector3d, 2> along;
  std::array<Eigen::Matrix2d, 2> whiten;
  for (std::size_t i = 0; i < 2; ++i) {
    const model::Device& eye = cameras_.devices[i];
    const auto n = eye.camera.normalize(point.q[i]);
    if (!n) {
      return std::nullopt;
    }
    const model::Pose back = eye.T_device_rig.inverse();
    from[i] = back.t;
    along[i] = back.q * n->homogeneous().normalized();
    whiten[i] = whitening(point.cov_q[i]);
  }
  const auto start = middle(from, along);
  if (!start) {
    return std::nullopt;
  }
  EyePoint seen{.x = point.x, .cov_x = point.cov_x, .p = *start, .covariance = {}, .p_by_z = {}, .between_by_z = {}};
  Eigen::Matrix<double, 4, 3> by_point;
  Eigen::Vector4d miss;
  // Gauss-Newton from the middle of the rays: quadratic, since they nearly meet.
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < 2; ++i) {
      const model::Device& eye = cameras_.devices[i];
      Eigen::Matrix<double, 2, 3> by_eye;
      const auto q = eye.camera.project(eye.T_device_rig * seen.p, by_eye);
      if (!q) {
        return std::nullopt;
      }
      const auto row = static_cast<Eigen::Index>(2 * i);
      miss.segment<2>(row) = whiten[i] * (*q - point.q[i]);
      by_point.middleRows<2>(row) = whiten[i] * by_eye * eye.T_device_rig.rotation();
    }
    if (round == 3) {
      break;
    }
    seen.p -= (by_point.transpose() * by_point).ldlt().solve(by_point.transpose() * miss);
  }
  seen.covariance = (by_point.transpose() * by_point).inverse();
  if (!seen.covariance.allFinite() || !seen.p.allFinite()) {
    return std::nullopt;
  }
  Eigen::MatrixXd by_camera = Eigen::MatrixXd::Zero(4, by_z_.rows());
  for (std::size_t i = 0; i < 2; ++i) {
    const model::Device& eye = cameras_.devices[i];
    const Eigen::Vector3d turned = eye.T_device_rig.q * seen.p;
    const Eigen::Vector3d there = turned + eye.T_device_rig.t;
    const int lens = 4 + model::coefficients(eye.camera.lens);
    auto block = by_camera.block(static_cast<Eigen::Index>(2 * i), cameras_.offset(i), 2, cameras_.count(i));
    block.leftCols(lens) = model::by_lens(eye.camera, there.hnormalized());
    if (i > 0) {
      Eigen::Matrix<double, 2, 3> by_there;
      eye.camera.project(there, by_there);
      block.middleCols<3>(lens) = -by_there * model::cross_matrix(turned);
      block.middleCols<3>(lens + 3) = by_there;
    }
    block = (whiten[i] * block).eval();
  }
  // Four residuals, three unknowns: what is left is the part along the one direction that no point can reach.
  const Eigen::Matrix4d q = by_point.fullPivHouseholderQr().matrixQ();
  const Eigen::RowVector4d beyond = q.col(3).transpose();
  const Eigen::MatrixXd by_z = by_camera * by_z_;
  seen.between_eyes = beyond * miss;
  seen.between_by_z = beyond * by_z;
  const Eigen::Matrix<double, 4, 6> by_right = by_camera.rightCols<6>();
  seen.between_by_right = beyond * by_right;
  seen.p_by_right = -seen.covariance * by_point.transpose() * by_right;
  seen.p_by_z = -seen.covariance * by_point.transpose() * by_z;
  return seen;
}

}  // namespace raysteer::calib::steer
