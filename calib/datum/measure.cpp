#include "calib/datum/measure.hpp"

#include <cmath>

#include "calib/datum/steady.hpp"

namespace raysteer::calib::datum {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::VectorXd;

// Left and right as the cameras' covariance may move them: parameters are L z with z of unit covariance.
class Eyes {
 public:
  explicit Eyes(const model::Rig& rig) : rig_(rig) {
    if (rig.covariance.size() == 0) {
      spread_.resize(0, 0);
      return;
    }
    // Pixels, radians and metres differ by orders of magnitude: in standard deviations all are alike.
    const VectorXd sigma = rig.covariance.diagonal().cwiseMax(0).cwiseSqrt();
    const VectorXd by_sigma = sigma.unaryExpr([](double s) { return s > 0 ? 1 / s : 0; });
    const MatrixXd correlation = by_sigma.asDiagonal() * rig.covariance * by_sigma.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(correlation);
    std::vector<VectorXd> columns;
    for (Eigen::Index i = 0; i < eigen.eigenvalues().size(); ++i) {
      if (eigen.eigenvalues()(i) > 1e-12) {
        columns.emplace_back(sigma.cwiseProduct(std::sqrt(eigen.eigenvalues()(i)) * eigen.eigenvectors().col(i)));
      }
    }
    spread_.resize(rig.covariance.rows(), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      spread_.col(static_cast<Eigen::Index>(i)) = columns[i];
    }
  }

  Eigen::Index unknowns() const { return spread_.cols(); }
  const MatrixXd& spread() const { return spread_; }
  model::Device eye(std::size_t i, const VectorXd& z) const {
    if (unknowns() == 0) {
      return rig_.devices[i];
    }
    const VectorXd delta = spread_.middleRows(rig_.offset(i), rig_.count(i)) * z;
    return model::perturbed(rig_.devices[i], delta, i > 0);
  }

 private:
  const model::Rig& rig_;
  MatrixXd spread_;
};

struct Sighted {
  unsigned code = 0;
  std::array<MeanSighting, 2> eyes;
  const Disc* disc = nullptr;
};

std::optional<Vector2d> predict(const model::Device& eye, const Vector3d& p, const Disc* disc) {
  const Vector3d p_eye = eye.T_device_rig * p;
  return disc == nullptr ? eye.camera.project(p_eye)
                         : target::ellipse_middle(eye.camera, p_eye, eye.T_device_rig.q * disc->normal, disc->radius_m);
}

// The point nearest to both rays.
std::optional<Vector3d> between(const model::Rig& rig, const Sighted& datum) {
  std::array<Vector3d, 2> from, along;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto n = rig.devices[i].camera.normalize(datum.eyes[i].q);
    if (!n) {
      return std::nullopt;
    }
    const model::Pose T_rig_eye = rig.devices[i].T_device_rig.inverse();
    from[i] = T_rig_eye.t;
    along[i] = (T_rig_eye.q * n->homogeneous()).normalized();
  }
  const double cosine = along[0].dot(along[1]);
  const double det = 1 - cosine * cosine;
  if (det < 1e-8) {
    return std::nullopt;
  }
  const Vector3d base = from[1] - from[0];
  const double a = (base.dot(along[0]) - cosine * base.dot(along[1])) / det;
  const double b = (cosine * base.dot(along[0]) - base.dot(along[1])) / det;
  if (!(a > 0) || !(b > 0)) {
    return std::nullopt;
  }
  return 0.5 * (from[0] + a * along[0] + from[1] + b * along[1]);
}

/// Gauss-Newton over all points and the cameras' z. Whitened rows: four a datum, then z itself.
class Problem {
 public:
  Problem(const Eyes& eyes, const std::vector<Sighted>& datums, std::vector<Vector3d> start)
      : eyes_(eyes), datums_(datums), p_(std::move(start)), z_(VectorXd::Zero(eyes.unknowns())) {}

  bool solve() {
    constexpr int kIterations = 8;
    for (int i = 0; i < kIterations; ++i) {
      if (!linearise()) {
        return false;
      }
      const VectorXd step = -normal_.ldlt().solve(right_);
      if (!step.allFinite()) {
        return false;
      }
      for (std::size_t k = 0; k < p_.size(); ++k) {
        p_[k] += step.segment<3>(3 * static_cast<Eigen::Index>(k));
      }
      z_ += step.tail(z_.size());
      if (step.norm() < 1e-9) {
        break;
      }
    }
    return linearise();
  }

  Measured result() const {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(p_.size());
    const MatrixXd cov = normal_.ldlt().solve(MatrixXd::Identity(normal_.rows(), normal_.cols()));
    Measured measured;
    for (const Sighted& datum : datums_) {
      measured.codes.push_back(datum.code);
    }
    measured.p = p_;
    measured.cov = cov.topLeftCorner(n, n);
    measured.cov_cameras = cov.topRightCorner(n, z_.size()) * eyes_.spread().transpose();
    measured.chi_square = cost_;
    measured.dof = static_cast<int>(p_.size());
    return measured;
  }

 private:
  bool linearise() {
    const Eigen::Index n = 3 * static_cast<Eigen::Index>(p_.size());
    const Eigen::Index all = n + z_.size();
    normal_ = MatrixXd::Zero(all, all);
    normal_.bottomRightCorner(z_.size(), z_.size()).setIdentity();
    right_ = VectorXd::Zero(all);
    right_.tail(z_.size()) = z_;
    cost_ = z_.squaredNorm();
    for (std::size_t i = 0; i < 2; ++i) {
      const model::Device eye = eyes_.eye(i, z_);
      constexpr double kStep = 0.1;  // of a standard deviation
      std::vector<std::array<model::Device, 2>> moved;
      for (Eigen::Index k = 0; k < z_.size(); ++k) {
        const VectorXd h = kStep * VectorXd::Unit(z_.size(), k);
        moved.push_back({eyes_.eye(i, z_ - h), eyes_.eye(i, z_ + h)});
      }
      for (std::size_t d = 0; d < datums_.size(); ++d) {
        const Sighted& datum = datums_[d];
        const auto q = predict(eye, p_[d], datum.disc);
        Eigen::Matrix<double, 2, 3> by_point;
        if (!q || !eye.camera.project(eye.T_device_rig * p_[d], by_point)) {
          return false;
        }
        const Eigen::Index at = 3 * static_cast<Eigen::Index>(d);
        Eigen::Matrix<double, 2, Eigen::Dynamic> rows(2, all);
        rows.setZero();
        rows.middleCols<3>(at) = by_point * eye.T_device_rig.rotation();
        for (std::size_t k = 0; k < moved.size(); ++k) {
          // How an ellipse's middle differs from the disc's changes too little with the cameras to matter here.
          const auto less = predict(moved[k][0], p_[d], nullptr);
          const auto more = predict(moved[k][1], p_[d], nullptr);
          if (!less || !more) {
            return false;
          }
          rows.col(n + static_cast<Eigen::Index>(k)) = (*more - *less) / (2 * kStep);
        }
        const Eigen::Matrix2d weight = datum.eyes[i].cov.inverse();
        const Vector2d residual = *q - datum.eyes[i].q;
        normal_ += rows.transpose() * weight * rows;
        right_ += rows.transpose() * weight * residual;
        cost_ += residual.dot(weight * residual);
      }
    }
    return std::isfinite(cost_);
  }

  const Eyes& eyes_;
  const std::vector<Sighted>& datums_;
  std::vector<Vector3d> p_;
  VectorXd z_;
  MatrixXd normal_;
  VectorXd right_;
  double cost_ = 0;
};

Status check_cameras(const model::Rig& cameras) {
  if (cameras.devices.size() < 2 || cameras.devices[0].kind != model::DeviceKind::kCamera ||
      cameras.devices[1].kind != model::DeviceKind::kCamera) {
    return fail(RCode::kCameraCount, "datums are measured by two cameras, the left one first");
  }
  Eigen::Index size = 0;
  for (std::size_t i = 0; i < cameras.devices.size(); ++i) {
    size += cameras.count(i);
  }
  if (cameras.covariance.size() != 0 && (cameras.covariance.rows() != size || cameras.covariance.cols() != size)) {
    return fail(RCode::kBadCalibrationFile, "the covariance has " + std::to_string(cameras.covariance.rows()) +
                                                " rows, the devices " + std::to_string(size) + " parameters");
  }
  if (!cameras.covariance.allFinite()) {
    return fail(RCode::kNotFinite, "the cameras' covariance");
  }
  return ok();
}

}  // namespace

Result<Measured> measure(const model::Rig& cameras, const std::vector<View>& views,
                         const std::map<unsigned, Disc>& discs) {
  RAYSTEER_TRY(check_cameras(cameras));
  const auto means = steady(views);
  RAYSTEER_TRY(means);
  std::vector<Sighted> datums;
  std::vector<Vector3d> start;
  std::vector<unsigned> one_eyed;
  for (const auto& [code, eyes] : *means) {
    if (!eyes[0] || !eyes[1]) {
      one_eyed.push_back(code);
      continue;
    }
    const auto disc = discs.find(code);
    datums.push_back(
        {.code = code, .eyes = {*eyes[0], *eyes[1]}, .disc = disc == discs.end() ? nullptr : &disc->second});
    const auto p = between(cameras, datums.back());
    if (!p) {
      return fail(RCode::kSolverDiverged,
                  "the two eyes' rays to datum code " + std::to_string(code) + " do not meet before them");
    }
    start.push_back(*p);
  }
  if (datums.empty()) {
    return fail(RCode::kTooFewMatches, "no datum was seen by both eyes");
  }
  const Eyes eyes(cameras);
  Problem problem(eyes, datums, std::move(start));
  if (!problem.solve()) {
    return fail(RCode::kSolverDiverged, "the datums' places do not settle");
  }
  Measured measured = problem.result();
  measured.one_eyed = std::move(one_eyed);
  return measured;
}

}  // namespace raysteer::calib::datum
