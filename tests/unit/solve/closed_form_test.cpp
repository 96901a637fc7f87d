#include "calib/solve/closed_form.hpp"

#include <gtest/gtest.h>

#include "tests/support/solver_case.hpp"

namespace raysteer::calib::solve {
namespace {

std::vector<Eigen::Vector2d> plane_points() {
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i < 30; ++i) {
    points.emplace_back(0.05 * (i % 6), 0.05 * (i / 6));
  }
  return points;
}

model::Pose tilted(double angle, const Eigen::Vector3d& axis) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized())), {-0.1, -0.05, 1}};
}

Eigen::Matrix3d seen(const model::Pose& pose, double focal, const Eigen::Vector2d& centre) {
  std::vector<Eigen::Vector2d> image;
  for (const auto& p : plane_points()) {
    const Eigen::Vector3d c = pose * Eigen::Vector3d(p.x(), p.y(), 0);
    image.emplace_back(focal * c.x() / c.z() + centre.x(), focal * c.y() / c.z() + centre.y());
  }
  return *homography(plane_points(), image);
}

TEST(ClosedForm, tilted_planes_give_focal_length_and_pose) {
  const Eigen::Vector2d centre(320, 240);
  const std::vector<model::Pose> poses{tilted(0.4, {1, 0, 0}), tilted(-0.3, {0, 1, 0}), tilted(0.5, {1, 1, 0.3})};
  std::vector<Eigen::Matrix3d> homographies;
  for (const auto& pose : poses) {
    homographies.push_back(seen(pose, 777, centre));
  }
  const auto focal = focal_length(homographies, centre);
  ASSERT_TRUE(focal);
  EXPECT_NEAR(*focal, 777, 1e-6);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const model::Pose pose = plane_pose(homographies[i], *focal, centre);
    EXPECT_LT(pose.q.angularDistance(poses[i].q), 1e-7);
    EXPECT_LT((pose.t - poses[i].t).norm(), 1e-7);
  }
}

TEST(ClosedForm, planes_that_face_the_camera_leave_the_focal_length_open) {
  const Eigen::Vector2d centre(320, 240);
  const model::Pose frontal{Eigen::Quaterniond::Identity(), {-0.1, -0.05, 1}};
  EXPECT_FALSE(focal_length(std::vector<Eigen::Matrix3d>{}, centre));
  const auto focal = focal_length(std::vector{seen(frontal, 777, centre)}, centre);
  EXPECT_TRUE(!focal || std::abs(*focal - 777) > 1);
}

std::vector<Eigen::Vector3d> cloud() {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < 40; ++i) {
    points.emplace_back(0.1 * (i % 5), 0.1 * (i / 8), 2 + 0.07 * (i % 7));
  }
  return points;
}

TEST(ClosedForm, resection_finds_a_principal_point_outside_the_panel) {
  const model::Camera camera{.width = 1024, .height = 768, .fx = 1892, .fy = 1880, .cx = 502, .cy = 854};
  const model::Pose pose = tilted(0.3, {0.2, 1, 0});
  std::vector<Eigen::Vector2d> pixels;
  for (const auto& p : cloud()) {
    pixels.push_back(*camera.project(pose * p));
  }
  const auto found = resection(cloud(), pixels);
  ASSERT_TRUE(found);
  EXPECT_FALSE(found->mirrored);
  EXPECT_NEAR(found->fx, 1892, 1e-3);
  EXPECT_NEAR(found->fy, 1880, 1e-3);
  EXPECT_NEAR(found->cx, 502, 1e-3);
  EXPECT_NEAR(found->cy, 854, 1e-3);
  EXPECT_LT((found->T_device_world.t - pose.t).norm(), 1e-5);
}

TEST(ClosedForm, resection_tells_a_flipped_image) {
  const model::Camera camera{.width = 1024, .height = 768, .fx = 1892, .fy = 1880, .cx = 502, .cy = 854};
  std::vector<Eigen::Vector2d> pixels;
  for (const auto& p : cloud()) {
    const auto q = *camera.project(tilted(0.3, {0.2, 1, 0}) * p);
    pixels.emplace_back(camera.width - 1 - q.x(), q.y());
  }
  const auto found = resection(cloud(), pixels);
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->mirrored);
}

TEST(ClosedForm, one_odd_pose_does_not_move_the_median) {
  std::vector<model::Pose> poses(7, tilted(0.2, {0, 1, 0}));
  poses[3] = tilted(1.2, {1, 0, 0});
  poses[3].t = {5, 5, 5};
  const model::Pose middle = median_pose(poses);
  EXPECT_LT(middle.q.angularDistance(poses[0].q), 1e-9);
  EXPECT_LT((middle.t - poses[0].t).norm(), 1e-9);
}

}  // namespace
}  // namespace raysteer::calib::solve
