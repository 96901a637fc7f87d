#include "host/rig/measured_pixel.hpp"

#include <algorithm>
#include <cmath>

#include "calib/steer/eye_points.hpp"
#include "calib/steer/room_derivatives.hpp"

namespace raysteer::host::rig {
namespace {

constexpr std::size_t kNearest = 30;

/// Of cameras and pose.
Eigen::MatrixXd covariance_of(const calib::steer::InRoom& rig) {
  const Eigen::Index cameras = rig.solution.camera_parameters();
  const Eigen::Index pose = rig.covariance.rows() - 6;
  Eigen::MatrixXd covariance(cameras + 6, cameras + 6);
  covariance << rig.covariance.topLeftCorner(cameras, cameras), rig.covariance.block(0, pose, cameras, 6),
      rig.covariance.block(pose, 0, 6, cameras), rig.covariance.bottomRightCorner<6, 6>();
  return covariance;
}

}  // namespace

std::vector<SeenPixel> seen_pixels(const calib::steer::InRoom& rig, const calib::steer::Look& look) {
  const Eigen::Index cameras = rig.solution.camera_parameters();
  const Eigen::MatrixXd each = Eigen::MatrixXd::Identity(cameras, cameras);
  const calib::steer::Eyes eyes(rig.solution.cameras, each);
  const calib::model::Pose T_room_rig = rig.T_rig_room.inverse();
  std::vector<SeenPixel> all;
  for (const calib::steer::LitPoint& point : look.points) {
    const auto seen = eyes.see(point);
    if (!seen) {
      continue;
    }
    SeenPixel& pixel = all.emplace_back(SeenPixel{.x = point.x, .p_room = T_room_rig * seen->p, .by = {}});
    pixel.by.resize(3, cameras + 6);
    pixel.by << seen->p_by_z, -calib::steer::by_increment(rig.T_rig_room.q * pixel.p_room);
    pixel.by = (T_room_rig.rotation() * pixel.by).eval();
  }
  return all;
}

Eigen::Matrix3d common_covariance(const calib::steer::InRoom& rig, const Eigen::Matrix<double, 3, Eigen::Dynamic>& by) {
  return by * covariance_of(rig) * by.transpose();
}

std::optional<MeasuredPixel> measure_pixel(const calib::steer::InRoom& rig, const Eigen::Vector2d& x,
                                           std::span<const SeenPixel> seen) {
  if (seen.size() < kFewestAround) {
    return std::nullopt;
  }
  std::vector<const SeenPixel*> nearest;
  for (const SeenPixel& pixel : seen) {
    nearest.push_back(&pixel);
  }
  const auto distance = [&](const SeenPixel* pixel) { return (pixel->x - x).norm(); };
  const std::size_t used = std::min(kNearest, nearest.size());
  std::ranges::partial_sort(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(used), {}, distance);
  const auto n = static_cast<Eigen::Index>(used);
  const double reach = std::max(distance(nearest[used - 1]), 1.0);
  Eigen::MatrixXd terms(n, 6);
  Eigen::VectorXd weights(n);
  Eigen::MatrixXd places(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    const SeenPixel& pixel = *nearest[static_cast<std::size_t>(k)];
    const Eigen::Vector2d d = (pixel.x - x) / reach;
    terms.row(k) << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y();
    weights[k] = 1 / (0.1 + d.squaredNorm());  // farther ones count less
    places.row(k) = pixel.p_room.transpose();
  }
  const Eigen::LDLT<Eigen::MatrixXd> normal((terms.transpose() * weights.asDiagonal() * terms).eval());
  if (normal.info() != Eigen::Success || !(normal.rcond() > 1e-9)) {
    return std::nullopt;
  }
  const Eigen::MatrixXd smoother = normal.solve(terms.transpose() * weights.asDiagonal());  // 6 x n
  const Eigen::RowVectorXd shares = smoother.row(0);  // of each point in the value at x
  const Eigen::MatrixXd misses = places - terms * (smoother * places);
  // What a weighted fit leaves of unit noise is the trace of (I - T S)^T (I - T S).
  const Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n) - terms * smoother;
  const double dof = left.squaredNorm();
  // The noise is not known but taken from few misses: Student's t has a wider spread than the normal distribution.
  const double spread = dof > 3 ? dof / (dof - 2) : 3;
  Eigen::Matrix<double, 3, Eigen::Dynamic> by = Eigen::MatrixXd::Zero(3, nearest[0]->by.cols());
  for (Eigen::Index k = 0; k < n; ++k) {
    by += shares[k] * nearest[static_cast<std::size_t>(k)]->by;
  }
  const Eigen::Matrix3d noise = misses.transpose() * misses / dof;
  return MeasuredPixel{.p_room = (shares * places).transpose(),
                       .covariance = spread * shares.squaredNorm() * noise + common_covariance(rig, by)};
}

}  // namespace raysteer::host::rig
