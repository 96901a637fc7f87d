#include "calib/assess/on_surface.hpp"

#include <gtest/gtest.h>

#include "calib/synth/noise.hpp"
#include "tests/support/floor_task.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::assess {
namespace {

TEST(Radius95, is_that_of_a_circle_and_of_a_line_at_its_ends) {
  EXPECT_NEAR(radius_95(Eigen::Matrix2d::Identity()), std::sqrt(5.991464547), 1e-4);
  EXPECT_NEAR(radius_95(Eigen::Vector2d(0, 4).asDiagonal()), 2 * 1.959963985, 1e-3);
  EXPECT_EQ(radius_95(Eigen::Matrix2d::Zero()), 0);
}

TEST(Radius95, holds_95_percent_of_drawn_errors) {
  synth::Noise noise(support::seed());
  for (int trial = 0; trial < 5; ++trial) {
    Eigen::Matrix2d root;
    root << noise.normal(), noise.normal(), noise.normal(), noise.normal();
    const double radius = radius_95(root * root.transpose());
    constexpr int kDraws = 20000;
    int inside = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = noise.normal();
      inside += (root * Eigen::Vector2d(x, noise.normal())).norm() < radius ? 1 : 0;
    }
    // One standard deviation of the share is 0.0015.
    EXPECT_NEAR(static_cast<double>(inside) / kDraws, 0.95, 0.0075);
  }
}

// One rig; what bounds are worth over many is tested in rig/steer_many.
class OnSurface : public testing::Test {
 protected:
  OnSurface()
      : board_(support::planned_board("mock-galvo", 16, 20e-6, 7)), trial_(board_, support::seed(), {.points = 25}) {}
  support::PlannedBoard board_;
  support::SteerTrial trial_;
};

TEST_F(OnSurface, the_reach_is_sure_to_a_millimetre_and_least_where_repeatability_is_all) {
  ASSERT_TRUE(trial_.solution()) << trial_.solution().error().message();
  const steer::Surface floor{.point = {0, 0, support::kFloorDepth}, .normal = Eigen::Vector3d::UnitZ()};
  const auto map = reach_map(*trial_.solution(), floor, board_.least_rad, board_.most_rad, 9, 7);
  ASSERT_EQ(map.cells.size(), 63U);
  // 95 % at one place against the plan's root mean square over all: 2.45 / 1.41 of it where errors are round.
  std::printf("95 %% of errors below %.2f mm in the middle of the reach, %.2f mm at worst; planned %.2f mm RMS\n",
              map.median_95_mm, map.worst_95_mm, board_.prediction.unseen_mm);
  EXPECT_GT(map.median_95_mm, 0.8 * board_.prediction.unseen_mm);
  EXPECT_LT(map.median_95_mm, 4 * board_.prediction.unseen_mm);
  for (const auto& cell : map.cells) {
    ASSERT_TRUE(cell);
    EXPECT_LE(cell->middle_95_mm, cell->worst_95_mm);
    EXPECT_NEAR(cell->p.z(), support::kFloorDepth, 1e-9);
    EXPECT_GT(cell->middle_95_mm, 0.05);
  }
}

TEST_F(OnSurface, a_surface_behind_the_rig_is_not_reached) {
  ASSERT_TRUE(trial_.solution());
  const steer::Surface behind{.point = {0, 0, -3}, .normal = Eigen::Vector3d::UnitZ()};
  const auto map = reach_map(*trial_.solution(), behind, board_.least_rad, board_.most_rad, 3, 3);
  EXPECT_TRUE(std::ranges::none_of(map.cells, [](const auto& cell) { return cell.has_value(); }));
  EXPECT_TRUE(std::isnan(map.worst_95_mm));
}

TEST_F(OnSurface, a_closed_loop_makes_corners_surer) {
  ASSERT_TRUE(trial_.solution());
  Noise noise(support::seed(), 3);
  const auto room = support::tied_to_room(trial_, {}, noise);
  ASSERT_TRUE(room);
  const std::array<Eigen::Vector3d, 2> corners{Eigen::Vector3d(0.1, 0.1, support::kFloorDepth),
                                               Eigen::Vector3d(0.4, 0.3, support::kFloorDepth)};
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitZ();
  const auto open = corner_bounds(*room, {0.02, 0.01}, corners, up);
  const Eigen::Vector2d angles = trial_.rig().projector.angles({0.02, 0.01});
  const auto refined =
      steer::refine_look(room->solution, {0.02, 0.01}, trial_.dots(angles, 20, noise, room->solution.cameras));
  ASSERT_TRUE(refined);
  const auto closed = corner_bounds(*room, {0.02, 0.01}, corners, up, refined->state);
  ASSERT_TRUE(open && closed);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    EXPECT_LT((*closed)[k].error_95_mm, (*open)[k].error_95_mm);
    EXPECT_LT((*open)[k].error_95_mm, 1);
  }
}

}  // namespace
}  // namespace raysteer::calib::assess
