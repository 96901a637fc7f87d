#include "calib/solve/adjust.hpp"

#include <ceres/ceres.h>

#include <array>
#include <cmath>
#include <memory>
#include <string>

#include "calib/solve/residual.hpp"

namespace raysteer::calib::solve {
namespace {

// A pose as Ceres holds it: quaternion x y z w, translation. Cost functions give derivatives by the six increments in
// the first six columns, so the manifold's own Jacobian is the identity over a row of zeros.
using PoseBlock = std::array<double, 7>;

PoseBlock to_block(const model::Pose& pose) {
  return {pose.q.x(), pose.q.y(), pose.q.z(), pose.q.w(), pose.t.x(), pose.t.y(), pose.t.z()};
}

model::Pose to_pose(const double* block) {
  return {Eigen::Quaterniond(block[3], block[0], block[1], block[2]), {block[4], block[5], block[6]}};
}

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* moved) const override {
    const PoseBlock block = to_block(model::moved_by(to_pose(x), Eigen::Map<const Eigen::Matrix<double, 6, 1>>(delta)));
    std::copy(block.begin(), block.end(), moved);
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>> map(jacobian);
    map.setZero();
    map.topRows<6>().setIdentity();
    return true;
  }
  bool Minus(const double* /*y*/, const double* /*x*/, double* /*difference*/) const override { return false; }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>> map(jacobian);
    map.setZero();
    map.leftCols<6>().setIdentity();
    return true;
  }
};

template <int kColumns, class Derivative>
void put(double* jacobian, const Derivative& derivative, double weight) {
  if (jacobian != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 2, kColumns, Eigen::RowMajor>> map(jacobian);
    map.setZero();
    map.template leftCols<Derivative::ColsAtCompileTime>() = weight * derivative;
  }
}

model::Camera with_intrinsics(model::Camera camera, const double* block) {
  set_intrinsics(camera, block);
  return camera;
}

class CornerCost final : public ceres::SizedCostFunction<2, kIntrinsics, 7, 7, 2> {
 public:
  CornerCost(const TargetSpec& target, const CornerMeasurement& corner, const model::Camera& camera, double weight)
      : target_(target), corner_(corner), camera_(camera), weight_(weight) {}
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    Eigen::Vector2d residual;
    CornerDerivatives by;
    if (!corner_residual(target_, corner_, with_intrinsics(camera_, blocks[0]), to_pose(blocks[1]), to_pose(blocks[2]),
                         {blocks[3][0], blocks[3][1]}, residual, jacobians != nullptr ? &by : nullptr)) {
      return false;
    }
    residuals[0] = weight_ * residual.x();
    residuals[1] = weight_ * residual.y();
    if (jacobians != nullptr) {
      put<kIntrinsics>(jacobians[0], by.by_intrinsics, weight_);
      put<7>(jacobians[1], by.by_device, weight_);
      put<7>(jacobians[2], by.by_view, weight_);
      put<2>(jacobians[3], by.by_sag, weight_);
    }
    return true;
  }

 private:
  const TargetSpec& target_;
  const CornerMeasurement& corner_;
  const model::Camera& camera_;
  double weight_;
};

class PixelCost final : public ceres::SizedCostFunction<2, kIntrinsics, 7, kIntrinsics, 7, 7, 2> {
 public:
  PixelCost(const TargetSpec& target, const PixelMeasurement& pixel, const model::Camera& camera,
            const model::Camera& projector, double weight)
      : target_(target), pixel_(pixel), camera_(camera), projector_(projector), weight_(weight) {}
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    Eigen::Vector2d residual;
    PixelDerivatives by;
    if (!pixel_residual(target_, pixel_, with_intrinsics(camera_, blocks[0]), to_pose(blocks[1]),
                        with_intrinsics(projector_, blocks[2]), to_pose(blocks[3]), to_pose(blocks[4]),
                        {blocks[5][0], blocks[5][1]}, residual, jacobians != nullptr ? &by : nullptr)) {
      return false;
    }
    residuals[0] = weight_ * residual.x();
    residuals[1] = weight_ * residual.y();
    if (jacobians != nullptr) {
      put<kIntrinsics>(jacobians[0], by.by_camera, weight_);
      put<7>(jacobians[1], by.by_camera_pose, weight_);
      put<kIntrinsics>(jacobians[2], by.by_projector, weight_);
      put<7>(jacobians[3], by.by_projector_pose, weight_);
      put<7>(jacobians[4], by.by_view, weight_);
      put<2>(jacobians[5], by.by_sag, weight_);
    }
    return true;
  }

 private:
  const TargetSpec& target_;
  const PixelMeasurement& pixel_;
  const model::Camera& camera_;
  const model::Camera& projector_;
  double weight_;
};

class SagPrior final : public ceres::SizedCostFunction<2, 2> {
 public:
  explicit SagPrior(double sigma) : sigma_(sigma) {}
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    residuals[0] = blocks[0][0] / sigma_;
    residuals[1] = blocks[0][1] / sigma_;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix2d> map(jacobians[0]);
      map = Eigen::Matrix2d::Identity() / sigma_;
    }
    return true;
  }

 private:
  double sigma_;
};

class AspectPrior final : public ceres::SizedCostFunction<1, kIntrinsics> {
 public:
  bool Evaluate(const double* const* blocks, double* residuals, double** jacobians) const override {
    const double fx = blocks[0][0];
    const double fy = blocks[0][1];
    residuals[0] = (fx / fy - 1) / kProjectorAspectSigma;
    if (jacobians != nullptr && jacobians[0] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, 1, kIntrinsics>> map(jacobians[0]);
      map.setZero();
      map[0] = 1 / fy / kProjectorAspectSigma;
      map[1] = -fx / (fy * fy) / kProjectorAspectSigma;
    }
    return true;
  }
};

bool chosen(const std::vector<bool>& flags, std::size_t i) { return flags.empty() || flags[i]; }

// Positions in the block of 12 that this lens model has.
std::vector<int> lens_positions(const model::Camera& camera) {
  std::vector<int> positions{0, 1, 2, 3};
  for (int i = 0; i < coefficients(camera.lens); ++i) {
    positions.push_back(4 + i);
  }
  return positions;
}

std::vector<int> fixed_positions(const AdjustOptions& options, std::size_t device, const model::Camera& camera) {
  std::vector<int> fixed;
  const int last = chosen(options.free_distortion, device) ? 4 + coefficients(camera.lens) : 4;
  for (int i = 0; i < kIntrinsics; ++i) {
    if (i >= last || (i < 2 && !chosen(options.free_focal, device))) {
      fixed.push_back(i);
    }
  }
  return fixed;
}

double corner_weight(const Measurements& measurements, const CornerMeasurement& corner) {
  return 1 / measurements.corner_sigma_px[static_cast<std::size_t>(corner.device)];
}

double pixel_weight(const Measurements& measurements, const PixelMeasurement& pixel) {
  return 1 / pixel_sigma(measurements, pixel);
}

}  // namespace

double pixel_sigma(const Measurements& measurements, const PixelMeasurement& pixel) {
  return std::max(kSigmaFloor, measurements.pixel_scale * pixel.sigma_px);
}

double sag_sigma(const TargetSpec& target) {
  const double length = target.square_m * std::max(target.corner_columns(), target.corner_rows());
  return 10 * length * 0.3e-3 / 0.8;
}

Result<AdjustReport> adjust(const Measurements& measurements, const AdjustOptions& options, State& state) {
  std::vector<std::array<double, kIntrinsics>> lenses;
  std::vector<PoseBlock> devices;
  std::vector<PoseBlock> views;
  for (const model::Device& device : state.devices) {
    lenses.push_back(intrinsics(device.camera));
    devices.push_back(to_block(device.T_device_rig));
  }
  for (const model::Pose& pose : state.T_rig_target) {
    views.push_back(to_block(pose));
  }
  std::array<double, 2> sag{state.sag.x(), state.sag.y()};

  ceres::Problem::Options ownership;
  ownership.enable_fast_removal = false;
  ceres::Problem problem(ownership);
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (std::size_t i = 0; i < devices.size(); ++i) {
    problem.AddParameterBlock(lenses[i].data(), kIntrinsics);
    problem.AddParameterBlock(devices[i].data(), 7, new PoseManifold);
    ordering->AddElementToGroup(lenses[i].data(), 1);
    ordering->AddElementToGroup(devices[i].data(), 1);
    if (!chosen(options.free_intrinsics, i)) {
      problem.SetParameterBlockConstant(lenses[i].data());
    } else if (const auto fixed = fixed_positions(options, i, state.devices[i].camera); !fixed.empty()) {
      problem.SetManifold(lenses[i].data(), new ceres::SubsetManifold(kIntrinsics, fixed));
    }
    if (i == 0 || !chosen(options.free_pose, i)) {
      problem.SetParameterBlockConstant(devices[i].data());
    }
  }
  for (PoseBlock& view : views) {
    problem.AddParameterBlock(view.data(), 7, new PoseManifold);
    ordering->AddElementToGroup(view.data(), 0);
    if (!options.free_views) {
      problem.SetParameterBlockConstant(view.data());
    }
  }
  problem.AddParameterBlock(sag.data(), 2);
  ordering->AddElementToGroup(sag.data(), 1);
  if (!options.free_sag) {
    problem.SetParameterBlockConstant(sag.data());
  }

  const auto loss = [&]() -> ceres::LossFunction* { return options.robust ? new ceres::CauchyLoss(2.0) : nullptr; };
  for (const CornerMeasurement& corner : measurements.corners) {
    const auto device = static_cast<std::size_t>(corner.device);
    problem.AddResidualBlock(
        new CornerCost(measurements.target, corner, state.devices[device].camera, corner_weight(measurements, corner)),
        loss(), lenses[device].data(), devices[device].data(), views[static_cast<std::size_t>(corner.view)].data(),
        sag.data());
  }
  for (const PixelMeasurement& pixel : measurements.pixels) {
    const auto camera = static_cast<std::size_t>(pixel.camera);
    const auto projector = static_cast<std::size_t>(pixel.projector);
    problem.AddResidualBlock(new PixelCost(measurements.target, pixel, state.devices[camera].camera,
                                           state.devices[projector].camera, pixel_weight(measurements, pixel)),
                             loss(), lenses[camera].data(), devices[camera].data(), lenses[projector].data(),
                             devices[projector].data(), views[static_cast<std::size_t>(pixel.view)].data(), sag.data());
  }
  problem.AddResidualBlock(new SagPrior(sag_sigma(measurements.target)), nullptr, sag.data());
  for (std::size_t i = 0; i < devices.size(); ++i) {
    if (state.devices[i].kind == model::DeviceKind::kProjector) {
      problem.AddResidualBlock(new AspectPrior, nullptr, lenses[i].data());
    }
  }

  ceres::Solver::Options solver;
  solver.linear_solver_type = options.free_views ? ceres::DENSE_SCHUR : ceres::DENSE_QR;
  if (options.free_views) {
    solver.linear_solver_ordering = ordering;
  }
  solver.max_num_iterations = options.max_iterations;
  solver.function_tolerance = 1e-10;
  solver.gradient_tolerance = 1e-12;
  solver.parameter_tolerance = 1e-10;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    return fail(RCode::kSolverDiverged, summary.message);
  }

  State solved = state;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    set_intrinsics(solved.devices[i].camera, lenses[i].data());
    solved.devices[i].T_device_rig = to_pose(devices[i].data());
    RAYSTEER_TRY(model::check(solved.devices[i].camera));
  }
  for (std::size_t i = 0; i < views.size(); ++i) {
    solved.T_rig_target[i] = to_pose(views[i].data());
    if (!solved.T_rig_target[i].t.allFinite() || !solved.T_rig_target[i].q.coeffs().allFinite()) {
      return fail(RCode::kNotFinite, "the pose of a view is not finite");
    }
  }
  solved.sag = {sag[0], sag[1]};
  state = std::move(solved);
  return AdjustReport{.cost = summary.final_cost, .iterations = static_cast<int>(summary.iterations.size())};
}

namespace {

// Normal equations with the views' poses apart: A over what is shared, B and D per view.
struct Normal {
  Eigen::MatrixXd A;
  std::vector<Eigen::MatrixXd> B;
  std::vector<Eigen::Matrix<double, 6, 6>> D;
  std::vector<int> intrinsics;  // first row per device
  std::vector<int> pose;        // first row, -1 for the first device
  int sag = 0;
  std::vector<std::vector<int>> positions;  // of the 12, per device

  Normal(const State& state) {
    int size = 0;
    for (std::size_t i = 0; i < state.devices.size(); ++i) {
      positions.push_back(lens_positions(state.devices[i].camera));
      intrinsics.push_back(size);
      size += static_cast<int>(positions[i].size());
      pose.push_back(i == 0 ? -1 : size);
      size += i == 0 ? 0 : 6;
    }
    sag = size;
    size += 2;
    A = Eigen::MatrixXd::Zero(size, size);
    B.assign(state.T_rig_target.size(), Eigen::MatrixXd::Zero(size, 6));
    D.assign(state.T_rig_target.size(), Eigen::Matrix<double, 6, 6>::Zero());
  }

  void place(Eigen::MatrixXd& row, std::size_t device, const ByIntrinsics& by_lens, const ByPose& by_pose) const {
    for (std::size_t i = 0; i < positions[device].size(); ++i) {
      row.col(intrinsics[device] + static_cast<int>(i)) += by_lens.col(positions[device][i]);
    }
    if (pose[device] >= 0) {
      row.middleCols<6>(pose[device]) += by_pose;
    }
  }

  void add(const Eigen::MatrixXd& row, const ByPose& by_view, std::size_t view, double weight) {
    const double square = weight * weight;
    A.selfadjointView<Eigen::Lower>().rankUpdate(row.transpose(), square);
    B[view] += square * row.transpose() * by_view;
    D[view] += square * by_view.transpose() * by_view;
  }
};

}  // namespace

Result<Covariance> covariance(const Measurements& measurements, const State& state) {
  Normal normal(state);
  const auto size = normal.A.rows();
  Eigen::MatrixXd row(2, size);
  Eigen::Vector2d residual;
  for (const CornerMeasurement& corner : measurements.corners) {
    const auto device = static_cast<std::size_t>(corner.device);
    const auto view = static_cast<std::size_t>(corner.view);
    CornerDerivatives by;
    if (corner_residual(measurements.target, corner, state.devices[device].camera, state.devices[device].T_device_rig,
                        state.T_rig_target[view], state.sag, residual, &by)) {
      row.setZero();
      normal.place(row, device, by.by_intrinsics, by.by_device);
      row.middleCols<2>(normal.sag) = by.by_sag;
      normal.add(row, by.by_view, view, corner_weight(measurements, corner));
    }
  }
  for (const PixelMeasurement& pixel : measurements.pixels) {
    const auto camera = static_cast<std::size_t>(pixel.camera);
    const auto projector = static_cast<std::size_t>(pixel.projector);
    const auto view = static_cast<std::size_t>(pixel.view);
    PixelDerivatives by;
    if (pixel_residual(measurements.target, pixel, state.devices[camera].camera, state.devices[camera].T_device_rig,
                       state.devices[projector].camera, state.devices[projector].T_device_rig, state.T_rig_target[view],
                       state.sag, residual, &by)) {
      row.setZero();
      normal.place(row, camera, by.by_camera, by.by_camera_pose);
      normal.place(row, projector, by.by_projector, by.by_projector_pose);
      row.middleCols<2>(normal.sag) = by.by_sag;
      normal.add(row, by.by_view, view, pixel_weight(measurements, pixel));
    }
  }
  Eigen::MatrixXd reduced = normal.A.selfadjointView<Eigen::Lower>();
  const double sag = sag_sigma(measurements.target);
  reduced.diagonal().tail<2>().array() += 1 / (sag * sag);
  for (std::size_t i = 0; i < state.devices.size(); ++i) {
    if (state.devices[i].kind == model::DeviceKind::kProjector) {
      Eigen::VectorXd aspect = Eigen::VectorXd::Zero(size);
      const model::Camera& camera = state.devices[i].camera;
      aspect[normal.intrinsics[i]] = 1 / camera.fy / kProjectorAspectSigma;
      aspect[normal.intrinsics[i] + 1] = -camera.fx / (camera.fy * camera.fy) / kProjectorAspectSigma;
      reduced += aspect * aspect.transpose();
    }
  }
  for (std::size_t v = 0; v < normal.D.size(); ++v) {
    if (normal.D[v](0, 0) > 0) {
      reduced -= normal.B[v] * normal.D[v].ldlt().solve(normal.B[v].transpose());
    }
  }
  // Scaled to a unit diagonal first: focal lengths and distortion differ by many powers of ten.
  Eigen::VectorXd scale = reduced.diagonal();
  if (!scale.allFinite() || scale.minCoeff() <= 0) {
    return fail(RCode::kSolverDiverged, "the views leave a parameter open");
  }
  scale = scale.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * reduced * scale.asDiagonal());
  if (eigen.info() != Eigen::Success || eigen.eigenvalues().minCoeff() <= 1e-14) {
    return fail(RCode::kSolverDiverged, "the views leave a combination of parameters open");
  }
  Covariance result;
  result.shared =
      scale.asDiagonal() *
      (eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose()) *
      scale.asDiagonal();
  return result;
}

}  // namespace raysteer::calib::solve
