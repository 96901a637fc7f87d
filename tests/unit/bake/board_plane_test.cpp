// Where a board lies, and how sure that is.
#include "calib/look/board_plane.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "hal/base/noise.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::look {
namespace {

TargetSpec board() {
  TargetSpec target;
  target.columns = 9;
  target.rows = 6;
  target.square_m = 0.06;
  return target;
}
const TargetSpec kBoard = board();

struct Seen {
  model::Pose T_rig_plane;
  std::vector<Sight> sights;
};

/// A board about three metres below two eyes.
Seen seen(std::uint64_t seed, double noise_px) {
  Noise noise(seed, 0xb0a2d);
  Seen world;
  world.T_rig_plane = {model::rotation_by({noise.uniform(-0.2, 0.2), noise.uniform(-0.2, 0.2), noise.uniform(-3, 3)}),
                       {noise.uniform(-0.2, 0.2), noise.uniform(-0.2, 0.2), 3}};
  for (const double x : {0.0, 0.5}) {
    Sight sight{.camera = {.width = 1600, .height = 1200, .fx = 1500, .fy = 1500, .cx = 800, .cy = 600, .k = {-0.05}},
                .T_camera_rig = {model::rotation_by({0, x / 6, 0}), {-x, 0, 0}},
                .corners = {},
                .discs = {}};
    for (int id = 0; id < kBoard.corners(); ++id) {
      const auto q =
          sight.camera.project(sight.T_camera_rig * (world.T_rig_plane * target::corner_position(kBoard, id)));
      if (q) {
        const double dx = noise_px * noise.normal();
        sight.corners.push_back({id, *q + Eigen::Vector2d(dx, noise_px * noise.normal()), std::max(noise_px, 0.01)});
      }
    }
    world.sights.push_back(sight);
  }
  return world;
}

TEST(BoardPlane, is_exact_without_noise_by_one_eye_and_by_two) {
  const Seen world = seen(support::seed(), 0);
  for (const std::size_t eyes : {1U, 2U}) {
    const auto plane = board_plane(kBoard, std::span(world.sights).first(eyes));
    ASSERT_TRUE(plane) << plane.error().message();
    EXPECT_LT((plane->T_rig_plane.t - world.T_rig_plane.t).norm(), 1e-9);
    EXPECT_LT(plane->T_rig_plane.q.angularDistance(world.T_rig_plane.q), 1e-9);
  }
}

// 200 boards of 6 numbers: chi-square of 1200, whose standard deviation is 49.
TEST(BoardPlane, is_as_sure_as_it_says) {
  double sum = 0;
  for (std::uint64_t k = 0; k < 200; ++k) {
    const Seen world = seen(support::seed() + k, 0.05);
    const auto plane = board_plane(kBoard, world.sights);
    ASSERT_TRUE(plane);
    const Eigen::AngleAxisd turn(plane->T_rig_plane.q * world.T_rig_plane.q.conjugate());
    Eigen::Matrix<double, 6, 1> off;
    off << turn.angle() * turn.axis(), plane->T_rig_plane.t - world.T_rig_plane.t;
    sum += off.dot(plane->covariance.ldlt().solve(off));
  }
  EXPECT_GT(sum, 1200 * 0.75);  // covariances are raised by misfit, never lowered
  EXPECT_LT(sum, 1200 * 1.2);
}

TEST(BoardPlane, a_bent_board_and_one_hardly_seen_are_refused) {
  Seen world = seen(support::seed(), 0.05);
  for (target::Corner& corner : world.sights[0].corners) {
    corner.q.y() += 0.2 * std::pow(corner.id % 9 - 4, 2);
  }
  const auto bent = board_plane(kBoard, world.sights);
  ASSERT_FALSE(bent);
  EXPECT_EQ(bent.error().rcode, RCode::kLookNotSolved);
  for (Sight& sight : world.sights) {
    sight.corners.resize(5);
  }
  const auto few = board_plane(kBoard, world.sights);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().rcode, RCode::kTooFewCorrespondences);
  EXPECT_FALSE(board_plane(kBoard, {}));
}

}  // namespace
}  // namespace raysteer::calib::look
