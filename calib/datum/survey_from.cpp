#include <algorithm>
#include <cmath>
#include <string>

#include "calib/datum/tie.hpp"

namespace raysteer::calib::datum {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

/// Where the datums are relative to each other: what moves all of them together is taken out of the covariance.
MatrixXd without_motion(const std::vector<Vector3d>& p, const MatrixXd& cov) {
  const Eigen::Index n = static_cast<Eigen::Index>(p.size());
  MatrixXd motion(3 * n, 6);
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& each : p) {
    mean += each / static_cast<double>(n);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d arm = p[static_cast<std::size_t>(i)] - mean;
    motion.block<3, 3>(3 * i, 0) << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;
    motion.block<3, 3>(3 * i, 3).setIdentity();
  }
  const MatrixXd rest =
      MatrixXd::Identity(3 * n, 3 * n) - motion * (motion.transpose() * motion).ldlt().solve(motion.transpose());
  return rest * cov * rest.transpose();
}

/// z = 0 through the datums, z towards the rig, origin below the first, x towards the second.
model::Pose room_by(const std::vector<Vector3d>& p) {
  Vector3d mean = Vector3d::Zero();
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& each : p) {
    mean += each / static_cast<double>(p.size());
  }
  for (const Vector3d& each : p) {
    spread += (each - mean) * (each - mean).transpose();
  }
  Vector3d up = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  up = up.dot(mean) > 0 ? Vector3d(-up) : up;
  const Vector3d origin = p[0] - up * up.dot(p[0] - mean);
  const Vector3d towards = p[1] - p[0];
  const Vector3d x = (towards - up * up.dot(towards)).normalized();
  Eigen::Matrix3d R_rig_room;
  R_rig_room << x, up.cross(x), up;
  return model::Pose{Eigen::Quaterniond(R_rig_room).normalized(), origin}.inverse();
}

/// The disc's radius that its outline in the left eye's pictures shows, metres, to a tenth of a millimetre.
double radius_of(const model::Camera& left, const std::vector<View>& views, unsigned code, const Vector3d& p) {
  double sum = 0;
  int count = 0;
  for (const View& view : views) {
    for (const target::SeenDatum& seen : view.eyes[0]) {
      if (seen.code == code) {
        // The long axis of the ellipse: tilt shortens the other one only.
        sum += seen.shape.jacobiSvd().singularValues()(0) * p.z() / std::sqrt(left.fx * left.fy);
        ++count;
      }
    }
  }
  return std::max(1e-3, std::round(1e4 * sum / std::max(1, count)) / 1e4);
}

}  // namespace

Result<proto::survey::Survey> survey_from(const model::Rig& cameras, const std::vector<View>& views) {
  const auto measured = measure(cameras, views);
  RAYSTEER_TRY(measured);
  const std::vector<Vector3d>& p = measured->p;
  if (p.size() < 3) {
    return fail(RCode::kDatumsMissing,
                "both eyes see " + std::to_string(p.size()) + " datums; a survey needs three, better four");
  }
  const model::Pose T_room_rig = room_by(p);
  const MatrixXd cov = without_motion(p, measured->cov);
  proto::survey::Survey survey{.name = "surveyed by the rig", .by_rig = true, .datums = {}, .lengths = {}};
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vector3d place = T_room_rig * p[i];
    const Eigen::Matrix3d own = cov.block<3, 3>(3 * static_cast<Eigen::Index>(i), 3 * static_cast<Eigen::Index>(i));
    survey.datums.push_back({.name = "datum " + std::to_string(measured->codes[i]),
                             .code = measured->codes[i],
                             .radius_m = radius_of(cameras.devices[0].camera, views, measured->codes[i], p[i]),
                             .position_m = {place.x(), place.y(), place.z()},
                             .normal = {0, 0, 1},
                             // One number for all coordinates: the worst, as files have no covariances.
                             .sigma_mm = std::max(0.001, 1e3 * std::sqrt(own.eigenvalues().real().maxCoeff()))});
  }
  RAYSTEER_TRY(proto::survey::check(survey));
  return survey;
}

}  // namespace raysteer::calib::datum
