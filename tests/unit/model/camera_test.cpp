#include "calib/model/camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calib/model/rig.hpp"

namespace raysteer::calib::model {
namespace {

Camera wide() {
  Camera camera{.width = 1280, .height = 960, .fx = 900, .fy = 905, .cx = 652, .cy = 470, .lens = LensModel::kBc8};
  camera.k = {-0.28, 0.09, 0.0007, -0.0004, -0.012, 0.01, -0.004, 0.001};
  return camera;
}

TEST(Camera, normalizing_a_projected_point_gives_its_direction_back) {
  const Camera camera = wide();
  for (int y = 0; y < camera.height; y += 60) {
    for (int x = 0; x < camera.width; x += 64) {
      const auto n = camera.normalize({x, y});
      ASSERT_TRUE(n) << x << " " << y;
      const auto q = camera.project({n->x() * 2.5, n->y() * 2.5, 2.5});
      ASSERT_TRUE(q);
      EXPECT_NEAR(q->x(), x, 1e-8);
      EXPECT_NEAR(q->y(), y, 1e-8);
    }
  }
}

TEST(Camera, derivative_by_the_point_matches_differences) {
  const Camera camera = wide();
  const Eigen::Vector3d p(0.4, -0.3, 1.1);
  Eigen::Matrix<double, 2, 3> by_point;
  ASSERT_TRUE(camera.project(p, by_point));
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    const Eigen::Vector2d slope = (*camera.project(p + step) - *camera.project(p - step)) / (2 * kStep);
    EXPECT_NEAR((by_point.col(i) - slope).norm(), 0, 1e-4 * slope.norm()) << i;
  }
}

TEST(Camera, a_point_behind_it_has_no_pixel) {
  EXPECT_FALSE(wide().project({0, 0, -1}));
  EXPECT_FALSE(wide().project({0.1, 0, 0}));
  EXPECT_FALSE(wide().project({0, 0, std::numeric_limits<double>::quiet_NaN()}));
}

TEST(Camera, an_undistorted_lens_shifted_projector_keeps_its_principal_point_outside_the_panel) {
  const Camera projector{.width = 1024, .height = 768, .fx = 1900, .fy = 1900, .cx = 502, .cy = 854};
  EXPECT_TRUE(check(projector));
  EXPECT_TRUE(projector.is_monotonic());
  const auto n = projector.normalize({502, 854});
  ASSERT_TRUE(n);
  EXPECT_NEAR(n->norm(), 0, 1e-12);
}

TEST(Camera, a_lens_that_folds_the_image_is_not_monotonic) {
  Camera camera = wide();
  EXPECT_TRUE(camera.is_monotonic());
  camera.k = {-0.9, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_FALSE(camera.is_monotonic());
}

TEST(Camera, numbers_that_are_not_finite_are_refused) {
  Camera camera = wide();
  camera.k[1] = std::numeric_limits<double>::quiet_NaN();
  const Status status = check(camera);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().rcode, RCode::kNotFinite);
  camera = wide();
  camera.fx = -1;
  EXPECT_EQ(check(camera).error().rcode, RCode::kBadValue);
}

TEST(Camera, lens_names_go_both_ways) {
  for (const LensModel lens : {LensModel::kBc4, LensModel::kBc5, LensModel::kBc8}) {
    EXPECT_EQ(lens_from_string(to_string(lens)), lens);
  }
  EXPECT_FALSE(lens_from_string("fisheye"));
}

TEST(Rig, a_perturbed_device_has_the_parameters_asked_for) {
  Device device{.name = "right", .camera = wide(), .T_device_rig = {}};
  device.T_device_rig.t = {-0.1, 0.01, 0.02};
  Eigen::VectorXd delta = Eigen::VectorXd::LinSpaced(18, 0.001, 0.018);
  const Device moved = perturbed(device, delta, true);
  const Eigen::VectorXd difference = parameters(moved, true) - parameters(device, true);
  EXPECT_NEAR((difference.head<12>() - delta.head<12>()).norm(), 0, 1e-9);
  EXPECT_NEAR((difference.tail<3>() - delta.tail<3>()).norm(), 0, 1e-12);
  const Eigen::AngleAxisd turn(moved.T_device_rig.q * device.T_device_rig.q.conjugate());
  EXPECT_NEAR((turn.angle() * turn.axis() - delta.segment<3>(12)).norm(), 0, 1e-12);
}

TEST(Rig, offsets_skip_the_first_devices_pose) {
  Rig rig;
  rig.devices.push_back({.name = "left", .camera = wide()});
  rig.devices.push_back({.name = "right", .camera = wide()});
  rig.devices[1].camera.lens = LensModel::kBc5;
  EXPECT_EQ(rig.count(0), 12);
  EXPECT_EQ(rig.offset(1), 12);
  EXPECT_EQ(rig.count(1), 15);
  EXPECT_EQ(rig.find("right"), &rig.devices[1]);
  EXPECT_EQ(rig.find("middle"), nullptr);
}

}  // namespace
}  // namespace raysteer::calib::model
