#include "calib/solve/residual.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "tests/support/solver_case.hpp"

namespace raysteer::calib::solve {
namespace {

using support::Devices;

// Everything a residual depends on, to be moved a little.
struct Scene {
  TargetSpec target = support::solver_target();
  model::Rig rig = support::solver_rig(Devices::kProjector, 1);
  model::Pose T_rig_target{Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 0.5, 0.2).normalized())),
                           {-0.1, -0.08, 0.9}};
  Eigen::Vector2d sag{0.002, -0.003};
  Scene() {
    // A first device that is not at the origin tests its pose's derivative too.
    rig.devices[0].T_device_rig.q = Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitY()));
    rig.devices[0].T_device_rig.t = {0.02, -0.01, 0.03};
    rig.devices[0].camera.lens = rig.devices[1].camera.lens = model::LensModel::kBc8;
  }
};

using Change = std::function<void(Scene&, int, double)>;

void move_lens(Scene& scene, std::size_t device, int i, double step) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(kIntrinsics);
  delta[i] = step;
  scene.rig.devices[device] = perturbed(scene.rig.devices[device], delta, false);
}

void move_pose(model::Pose& pose, int i, double step) {
  pose = model::moved_by(pose, step * Eigen::Matrix<double, 6, 1>::Unit(i));
}

template <class Residual, class Derivative>
void expect_slopes(const Residual& residual, const Derivative& derivative, double step, const Change& change,
                   const char* what) {
  for (int i = 0; i < derivative.cols(); ++i) {
    Scene plus;
    Scene minus;
    change(plus, i, step);
    change(minus, i, -step);
    const Eigen::Vector2d slope = (residual(plus) - residual(minus)) / (2 * step);
    EXPECT_LT((derivative.col(i) - slope).norm(), 1e-5 * (1 + slope.norm())) << what << " " << i;
  }
}

TEST(CornerResidual, derivatives_match_differences) {
  const CornerMeasurement corner{.view = 0, .device = 0, .id = 13, .q = {600, 400}};
  CornerDerivatives by;
  const auto residual = [&](const Scene& s) {
    Eigen::Vector2d error;
    EXPECT_TRUE(corner_residual(s.target, corner, s.rig.devices[0].camera, s.rig.devices[0].T_device_rig,
                                s.T_rig_target, s.sag, error, &by));
    return error;
  };
  residual(Scene{});
  const CornerDerivatives at = by;
  expect_slopes(
      residual, at.by_intrinsics, 1e-5, [](Scene& s, int i, double h) { move_lens(s, 0, i, h); }, "lens");
  expect_slopes(
      residual, at.by_device, 1e-6, [](Scene& s, int i, double h) { move_pose(s.rig.devices[0].T_device_rig, i, h); },
      "device");
  expect_slopes(
      residual, at.by_view, 1e-6, [](Scene& s, int i, double h) { move_pose(s.T_rig_target, i, h); }, "view");
  expect_slopes(
      residual, at.by_sag, 1e-6, [](Scene& s, int i, double h) { s.sag[i] += h; }, "sag");
}

TEST(PixelResidual, derivatives_match_differences) {
  const PixelMeasurement pixel{.view = 0, .camera = 0, .projector = 1, .q = {650, 480}, .x = {500, 300}, .sigma_px = 1};
  PixelDerivatives by;
  const auto residual = [&](const Scene& s) {
    Eigen::Vector2d error;
    EXPECT_TRUE(pixel_residual(s.target, pixel, s.rig.devices[0].camera, s.rig.devices[0].T_device_rig,
                               s.rig.devices[1].camera, s.rig.devices[1].T_device_rig, s.T_rig_target, s.sag, error,
                               &by));
    return error;
  };
  residual(Scene{});
  const PixelDerivatives at = by;
  expect_slopes(
      residual, at.by_camera, 1e-5, [](Scene& s, int i, double h) { move_lens(s, 0, i, h); }, "camera lens");
  expect_slopes(
      residual, at.by_projector, 1e-5, [](Scene& s, int i, double h) { move_lens(s, 1, i, h); }, "projector lens");
  expect_slopes(
      residual, at.by_camera_pose, 1e-6,
      [](Scene& s, int i, double h) { move_pose(s.rig.devices[0].T_device_rig, i, h); }, "camera pose");
  expect_slopes(
      residual, at.by_projector_pose, 1e-6,
      [](Scene& s, int i, double h) { move_pose(s.rig.devices[1].T_device_rig, i, h); }, "projector pose");
  expect_slopes(
      residual, at.by_view, 1e-6, [](Scene& s, int i, double h) { move_pose(s.T_rig_target, i, h); }, "view");
  expect_slopes(
      residual, at.by_sag, 1e-6, [](Scene& s, int i, double h) { s.sag[i] += h; }, "sag");
}

TEST(PixelResidual, is_zero_where_camera_and_projector_see_the_same_point) {
  const Scene s;
  const Eigen::Vector3d p = s.T_rig_target * target_point(s.target, s.sag, 22);
  const auto q = s.rig.devices[0].camera.project(s.rig.devices[0].T_device_rig * p);
  const auto x = s.rig.devices[1].camera.project(s.rig.devices[1].T_device_rig * p);
  ASSERT_TRUE(q && x);
  Eigen::Vector2d error;
  const PixelMeasurement pixel{.view = 0, .camera = 0, .projector = 1, .q = *q, .x = *x, .sigma_px = 1};
  ASSERT_TRUE(pixel_residual(s.target, pixel, s.rig.devices[0].camera, s.rig.devices[0].T_device_rig,
                             s.rig.devices[1].camera, s.rig.devices[1].T_device_rig, s.T_rig_target, s.sag, error,
                             nullptr));
  EXPECT_LT(error.norm(), 1e-7);
}

}  // namespace
}  // namespace raysteer::calib::solve
