#include "sim/optics/mirror.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::sim::optics {
namespace {

Eigen::Vector3d direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

TEST(Plane, reflecting_twice_changes_nothing) {
  std::mt19937_64 random(support::seed());
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const Plane plane{direction(random), normal(random)};
    const Eigen::Vector3d p(normal(random), normal(random), normal(random));
    EXPECT_LT((plane.reflect_point(plane.reflect_point(p)) - p).norm(), 1e-14);
    EXPECT_LT((plane.reflect_direction(plane.reflect_direction(p)) - p).norm(), 1e-14);
    // The plane stands half-way.
    EXPECT_NEAR(plane.normal.dot(p + plane.reflect_point(p)) / 2, plane.distance, 1e-14);
  }
}

// By hand: a mirror at 45 degrees, 0.1 m ahead, with its glass 5 mm before its axis, turned by 10 degrees about y.
// n = (-sin 35, 0, -cos 35), the glass at (0, 0, 0.1) + 0.005 n, so d = n.(0, 0, 0.1) + 0.005
// = -0.1 * 0.8191520442889918 + 0.005 = -0.0769152044288992.
TEST(TrueMirror, galvo_step_is_as_worked_by_hand) {
  const double half = std::sqrt(0.5);
  TrueMirror mirror;
  mirror.parts[0] = {.axis = {0, 1, 0}, .point = {0, 0, 0.1}, .normal = {-half, 0, -half}, .offset_m = 0.005};
  // A turn by +10 degrees about +y takes -x towards +z: from (-sin 45, 0, -cos 45) to (-sin 55, 0, -cos 55); by -10,
  // to 35.
  const double ten = std::acos(-1.0) / 18;
  const auto poses = mirror.poses({Radians(ten), Radians(0)});
  const double degree = std::acos(-1.0) / 180;
  EXPECT_LT((poses[0].plane.normal - Eigen::Vector3d(-std::sin(55 * degree), 0, -std::cos(55 * degree))).norm(), 1e-15);
  const auto back = mirror.poses({Radians(-ten), Radians(0)});
  EXPECT_LT((back[0].plane.normal - Eigen::Vector3d(-0.573576436351046, 0, -0.8191520442889918)).norm(), 1e-15);
  EXPECT_NEAR(back[0].plane.distance, -0.0769152044288992, 1e-15);
}

// The planes of algorithms 4.2 and 4.3, written out with rotation matrices, against the poses that are moved about.
TEST(TrueMirror, planes_are_those_of_the_formulas_for_arbitrary_lines) {
  std::mt19937_64 random(support::seed());
  std::normal_distribution<double> normal(0, 0.1);
  const auto place = [&] { return Eigen::Vector3d(normal(random), normal(random), normal(random)); };
  const auto R = [](const Eigen::Vector3d& axis, double angle) {
    return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  };
  for (int i = 0; i < 50; ++i) {
    TrueMirror mirror;
    for (MirrorPart& part : mirror.parts) {
      part = {.axis = direction(random), .point = place(), .normal = direction(random), .offset_m = normal(random)};
    }
    mirror.outer_axis = direction(random);
    mirror.outer_point = place();
    const double a = normal(random);
    const double b = normal(random);

    mirror.head = false;
    const auto galvo = mirror.poses({Radians(a), Radians(b)});
    for (int k = 0; k < 2; ++k) {
      const MirrorPart& part = mirror.parts[k];
      const Eigen::Vector3d n = R(part.axis, k == 0 ? a : b) * part.normal;
      EXPECT_LT((galvo[k].plane.normal - n).norm(), 1e-14);
      EXPECT_NEAR(galvo[k].plane.distance, n.dot(part.point) + part.offset_m, 1e-14);
    }

    mirror.head = true;
    const MirrorPart& part = mirror.parts[0];
    const Eigen::Vector3d inner = R(part.axis, b) * part.normal;
    const Eigen::Vector3d n = R(mirror.outer_axis, a) * inner;
    const double d = n.dot(mirror.outer_point) + inner.dot(part.point - mirror.outer_point) + part.offset_m;
    const auto head = mirror.poses({Radians(a), Radians(b)});
    EXPECT_LT((head[0].plane.normal - n).norm(), 1e-14);
    EXPECT_NEAR(head[0].plane.distance, d, 1e-14);
  }
}

TEST(MirrorPose, slack_is_one_in_the_middle_zero_on_the_edge_and_negative_outside) {
  TrueMirror mirror;
  mirror.parts[0] = {.axis = {0, 1, 0}, .point = {1, 2, 3}, .normal = {0, 0, -1}, .half_size_m = {0.02, 0.04}};
  for (const bool ellipse : {true, false}) {
    mirror.parts[0].ellipse = ellipse;
    const MirrorPose pose = mirror.poses({})[0];
    EXPECT_NEAR(pose.slack({1, 2, 3}), 1, 1e-12);
    EXPECT_NEAR(pose.slack({1.02, 2, 3}), 0, 1e-12);
    EXPECT_NEAR(pose.slack({1, 1.96, 3}), 0, 1e-12);
    EXPECT_LT(pose.slack({1.03, 2, 3}), 0);
    // A corner belongs to the rectangle only.
    EXPECT_EQ(pose.slack({1.0199, 2.0399, 3}) > 0, !ellipse);
  }
}

}  // namespace
}  // namespace raysteer::sim::optics
