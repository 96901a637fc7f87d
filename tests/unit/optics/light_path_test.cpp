#include "sim/optics/light_path.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/seed.hpp"
#include "tests/unit/optics/boards.hpp"

namespace raysteer::sim::optics {
namespace {

// A projector in the rig's origin that looks along its z, 1000 px focal length, picture centre (0, 0).
TrueRig plain_rig() {
  TrueRig rig;
  rig.projector.width = 400;
  rig.projector.height = 300;
  rig.projector.lens = Lens({.focal_px = {1000, 1000}, .centre_px = {0, 0}});
  return rig;
}

// By hand: one mirror at 45 degrees, 1 m ahead, normal (-1, 0, -1)/sqrt 2, folds the light towards -x. The middle pixel
// goes (0,0,0) -> (0,0,1) -> along (-1,0,0). Pixel (100, 0) has direction (0.1, 0, 1)/sqrt 1.01; it meets x + z = 1 at
// 1/1.1: (0.090909..., 0, 0.909090...), and leaves along (-1, 0, -0.1)/sqrt 1.01. The lens is seen in the mirror at
// (1, 0, 1).
TEST(LightPath, one_mirror_at_45_degrees_is_as_worked_by_hand) {
  TrueRig rig = plain_rig();
  const double half = std::sqrt(0.5);
  rig.mirror.head = true;
  rig.mirror.parts[0] = {.axis = {0, 1, 0}, .point = {0, 0, 1}, .normal = {-half, 0, -half}};
  const LightPath path(rig, {});
  const auto middle = path.leave({0, 0});
  ASSERT_TRUE(middle && middle->passage.through);
  EXPECT_LT((middle->origin - Eigen::Vector3d(0, 0, 1)).norm(), 1e-14);
  EXPECT_LT((middle->direction - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-14);
  EXPECT_NEAR(middle->passage.cosine[0], half, 1e-14);
  const auto side = path.leave({100, 0});
  ASSERT_TRUE(side);
  EXPECT_LT((side->origin - Eigen::Vector3d(1 / 11.0, 0, 10 / 11.0)).norm(), 1e-14);
  EXPECT_LT((side->direction - Eigen::Vector3d(-1, 0, -0.1) / std::sqrt(1.01)).norm(), 1e-14);
  EXPECT_NEAR(side->passage.length_m, std::sqrt(1.01) / 1.1, 1e-14);
  EXPECT_LT((path.centre() - Eigen::Vector3d(1, 0, 1)).norm(), 1e-14);
  // And back: the point 1 m past the mirror on the middle ray is 2 m away along the light.
  const auto lit = path.lit_by({-1, 0, 1});
  ASSERT_TRUE(lit && lit->passage.through);
  EXPECT_LT(lit->x.norm(), 1e-11);
  EXPECT_NEAR(lit->distance_m, 2, 1e-14);
}

// By hand: the pair of a galvo at 45 degrees, 0.1 m ahead and 0.05 m apart, folds z to -x to +y. Turning the first
// mirror by 3 degrees turns the light leaving it by 6: (-cos 6, 0, +-sin 6); the second takes that to (0, cos 6, +-sin
// 6). A turn by +3 degrees about y takes the normal from (-1, 0, -1) towards (-1, 0, 0), so that light comes back: -z.
TEST(LightPath, one_galvo_step_turns_the_light_by_twice_the_angle) {
  TrueRig rig = plain_rig();
  const double half = std::sqrt(0.5);
  rig.mirror.parts[0] = {
      .axis = {0, 1, 0}, .point = {0, 0, 0.1}, .normal = {-half, 0, -half}, .half_size_m = {.02, .02}};
  rig.mirror.parts[1] = {
      .axis = {0, 0, 1}, .point = {-0.05, 0, 0.1}, .normal = {half, half, 0}, .half_size_m = {.02, .02}};
  const auto out = LightPath(rig, degrees(3, 0)).leave({0, 0});
  ASSERT_TRUE(out && out->passage.through);
  EXPECT_LT((out->direction - Eigen::Vector3d(0, 0.9945218953682733, 0.10452846326765347)).norm(), 1e-14);
  EXPECT_LT((out->origin - Eigen::Vector3d(-0.05, 0, 0.1 + 0.05 * 0.10510423526567646)).norm(), 1e-14);
  EXPECT_NEAR(out->passage.length_m, 0.1 + 0.05 / 0.9945218953682733, 1e-14);
}

TEST(LightPath, one_mirror_flips_handedness_and_two_restore_it) {
  for (const std::string& name : kBoards) {
    const TrueRig rig = rig_named(name);
    const LightPath path(rig, degrees(2, -3));
    EXPECT_NEAR(path.T_virtual_rig().linear().determinant(), rig.mirror.head ? -1 : 1, 1e-12) << name;
  }
}

TEST(LightPath, forwards_and_backwards_agree_at_any_look) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> share(0, 1);
  for (const std::string& name : kBoards) {
    const TrueRig rig = rig_named(name);
    for (int i = 0; i < 300; ++i) {
      const LightPath path(rig, degrees(20 * share(random) - 10, 20 * share(random) - 10));
      const Eigen::Vector2d x(rig.projector.width * share(random), rig.projector.height * share(random));
      const auto out = path.leave(x);
      ASSERT_TRUE(out);
      const double length = 0.5 + 5 * share(random);
      const Eigen::Vector3d p = out->origin + length * out->direction;
      const auto lit = path.lit_by(p);
      ASSERT_TRUE(lit);
      EXPECT_LT((lit->x - x).norm(), 1e-9);
      EXPECT_LT((*path.pixel(p) - x).norm(), 1e-9);
      EXPECT_NEAR(lit->distance_m, out->passage.length_m + length, 1e-12);
      EXPECT_LT((lit->origin - out->origin).norm(), 1e-12);
      EXPECT_NEAR(lit->passage.slack[0], out->passage.slack[0], 1e-9);
      EXPECT_EQ(lit->passage.through, out->passage.through);
      // Light seems to come straight from the virtual centre.
      EXPECT_NEAR((p - path.centre()).norm(), lit->distance_m, 1e-12);
    }
  }
}

TEST(LightPath, light_beside_a_mirror_is_cut) {
  TrueRig rig = plain_rig();
  const double half = std::sqrt(0.5);
  rig.mirror.head = true;
  rig.mirror.parts[0] = {
      .axis = {0, 1, 0}, .point = {0, 0, 1}, .normal = {-half, 0, -half}, .half_size_m = {1, 0.05}, .ellipse = false};
  const LightPath path(rig, {});
  EXPECT_TRUE(path.leave({0, 49})->passage.through);
  EXPECT_FALSE(path.leave({0, 51})->passage.through);
  EXPECT_TRUE(path.lit_by({-1, 0.099, 1})->passage.through);
  EXPECT_FALSE(path.lit_by({-1, 0.101, 1})->passage.through);
}

TEST(LightPath, nothing_behind_the_mirror_or_before_it_is_lit) {
  TrueRig rig = plain_rig();
  const double half = std::sqrt(0.5);
  rig.mirror.head = true;
  rig.mirror.parts[0] = {.axis = {0, 1, 0}, .point = {0, 0, 1}, .normal = {-half, 0, -half}};
  const LightPath path(rig, {});
  EXPECT_TRUE(path.lit_by({-0.1, 0, 1})->passage.through);
  const auto behind = path.lit_by({0.5, 0, 1});
  EXPECT_FALSE(behind && behind->passage.through);
  // Turned round, the mirror shows its back.
  rig.mirror.parts[0].normal = -rig.mirror.parts[0].normal;
  EXPECT_FALSE(LightPath(rig, {}).leave({0, 0})->passage.through);
}

TEST(LightPath, the_first_galvo_mirror_can_stand_in_the_way) {
  TrueRig rig = plain_rig();
  const double half = std::sqrt(0.5);
  rig.mirror.parts[0] = {
      .axis = {0, 1, 0}, .point = {0, 0, 0.1}, .normal = {-half, 0, -half}, .half_size_m = {.02, .02}};
  rig.mirror.parts[1] = {
      .axis = {0, 0, 1}, .point = {-0.05, 0, 0.1}, .normal = {half, half, 0}, .half_size_m = {.02, .02}};
  EXPECT_TRUE(LightPath(rig, {}).leave({0, 0})->passage.through);
  // The second sends the light steeply back over a first mirror that is far too long.
  rig.mirror.parts[0].half_size_m = {0.02, 0.5};
  EXPECT_FALSE(LightPath(rig, degrees(0, -35)).leave({0, 0})->passage.through);
  rig.mirror.parts[0].half_size_m = {0.02, 0.02};
  EXPECT_TRUE(LightPath(rig, degrees(0, -15)).leave({0, 0})->passage.through);
}

}  // namespace
}  // namespace raysteer::sim::optics
