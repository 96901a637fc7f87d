#include "calib/bake/aim.hpp"

#include <gtest/gtest.h>

#include "calib/bake/steering.hpp"
#include "calib/model/steered_look.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/steered_rig.hpp"
#include "tests/unit/bake/baked.hpp"

namespace raysteer::calib::bake {
namespace {

TEST(SteeringTable, lands_within_its_bound_at_a_hundred_thousand_places) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> part(0, 1);
  for (const std::string board : {"mock-galvo", "mock-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    const model::Pose T_rig_floor = support::floor_pose(random);
    const proto::lut::SteeringTable table = valid(bake_steering(
        rig.projector, {.T_frame_plane = T_rig_floor, .T_rig_plane = T_rig_floor, .bound_m = 2e-4, .farthest_m = 8}));
    const auto& parts = table.parts();
    const Eigen::Vector2d middle = panel_middle(rig.projector);
    double worst = 0;
    int commands = 0;
    for (int i = 0; i < 100'000; ++i) {
      const proto::lut::PlanePoint place{parts.origin.x + part(random) * parts.spacing_m * (parts.columns - 1),
                                         parts.origin.y + part(random) * parts.spacing_m * (parts.rows - 1)};
      if (const auto command = table.command(place)) {
        const auto lands =
            landing(rig.projector, T_rig_floor, middle, Eigen::Vector2d(command->axis1_rad, command->axis2_rad));
        ASSERT_TRUE(lands);
        worst = std::max(worst, (*lands - Eigen::Vector2d(place.x, place.y)).norm());
        ++commands;
      }
    }
    std::printf("%s: %d x %d nodes of %.0f mm; worst of %d places %.4f mm, when baked %.4f, bound %.4f\n",
                board.c_str(), parts.columns, parts.rows, 1e3 * parts.spacing_m, commands, 1e3 * worst,
                1e3 * parts.worst_m, 1e3 * parts.bound_m);
    EXPECT_GT(commands, 30'000);
    EXPECT_LE(worst, parts.bound_m);
    EXPECT_GT(worst, 0.2 * parts.bound_m);
  }
}

// The same, by a mirror whose truth is written here: it stands at (1 + gain) times its angles, and the offset on.
TEST(SteeringTable, makes_up_for_a_mirror_that_drifted) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> part(0, 1);
  for (const std::string board : {"mock-galvo", "mock-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    const model::Pose T_rig_floor = support::floor_pose(random);
    const MirrorDrift drift{.offset_rad = {1.5e-3, -1e-3}, .gain = {2e-3, -3e-3}};
    const proto::lut::SteeringTable table = valid(bake_steering(
        rig.projector,
        {.T_frame_plane = T_rig_floor, .T_rig_plane = T_rig_floor, .drift = drift, .bound_m = 2e-4, .farthest_m = 8}));
    const auto& parts = table.parts();
    const Eigen::Vector2d middle = panel_middle(rig.projector);
    double worst = 0;
    double without = 0;
    int commands = 0;
    for (int i = 0; i < 5000; ++i) {
      const proto::lut::PlanePoint place{parts.origin.x + part(random) * parts.spacing_m * (parts.columns - 1),
                                         parts.origin.y + part(random) * parts.spacing_m * (parts.rows - 1)};
      const auto command = table.command(place);
      if (!command) {
        continue;
      }
      const Eigen::Vector2d told(command->axis1_rad, command->axis2_rad);
      const Eigen::Vector2d means = rig.projector.angles(told);
      const Eigen::Vector2d latent = drift.offset_rad + drift.gain.cwiseProduct(means);
      const model::SteeredLook stands(rig.projector, told, latent);
      const auto x = stands.project(T_rig_floor * Eigen::Vector3d(place.x, place.y, 0));
      const auto as_told = rig.projector.at(told).project(T_rig_floor * Eigen::Vector3d(place.x, place.y, 0));
      ASSERT_TRUE(x && as_told);
      worst = std::max(worst, (*x - middle).norm());
      without = std::max(without, (*as_told - middle).norm());
      ++commands;
    }
    EXPECT_GT(commands, 1500);
    EXPECT_LT(worst, 0.5) << board << ", px: a fifth of a millimetre is less";
    EXPECT_GT(without, 3) << board << ", px: the drift";
  }
}

TEST(SteeringTable, reaches_what_the_light_reaches) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> share(-1, 1);
  for (const std::string board : {"mock-small", "mock-small-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    const model::Pose T_rig_floor = support::floor_pose(random);
    const proto::lut::SteeringTable table = valid(bake_steering(
        rig.projector, {.T_frame_plane = T_rig_floor, .T_rig_plane = T_rig_floor, .bound_m = 1e-3, .farthest_m = 6}));
    const Eigen::Vector2d middle = panel_middle(rig.projector);
    int reached = 0;
    int missed = 0;
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d command =
          0.97 * Eigen::Vector2d(share(random), share(random)).cwiseProduct(rig.projector.most_rad);
      const auto out = rig.path(command).leave(middle);
      const auto lands = landing(rig.projector, T_rig_floor, middle, command);
      if (lands && lands->norm() < 5.5 && out->passage.through) {
        (table.command({lands->x(), lands->y()}) ? reached : missed)++;
      }
    }
    EXPECT_GT(reached, 500);
    // Cells that an outline's edge crosses count as dark.
    EXPECT_LT(missed, reached / 50) << board;
    EXPECT_FALSE(table.command({1000, 0}));
  }
}

TEST(SteeringTable, that_no_grid_keeps_is_refused) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-small", random);
  const model::Pose T_rig_floor = support::floor_pose(random);
  EXPECT_EQ(bake_steering(rig.projector, {.T_rig_plane = T_rig_floor, .bound_m = 1e-10}).error().rcode,
            RCode::kTableBound);
  const model::Pose behind{.q = Eigen::Quaterniond::Identity(), .t = {0, 0, -3}};
  EXPECT_EQ(bake_steering(rig.projector, {.T_rig_plane = behind}).error().rcode, RCode::kStationOutOfReach);
  EXPECT_EQ(bake_steering(rig.projector, {.T_rig_plane = T_rig_floor, .bound_m = 0}).error().rcode, RCode::kBadValue);
}

TEST(StationCommand, shows_the_station_in_the_middle_of_the_panel) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> part(-1, 1);
  for (const std::string board : {"mock-galvo", "mock-head"}) {
    const support::SteeredRig rig = support::steered_rig(board, random);
    for (int i = 0; i < 10; ++i) {
      const Station station = support::station_at("bench", support::floor_pose(random), 0.8 * part(random),
                                                  0.8 * part(random), 3 * part(random));
      const Eigen::Vector2d command = valid(station_command(rig.projector, station));
      const sim::optics::LightPath path = rig.path(command);
      Eigen::Vector2d least(1e9, 1e9);
      Eigen::Vector2d most = -least;
      for (const Eigen::Vector3d& corner : corners(station)) {
        const auto lit = path.lit_by(corner);
        ASSERT_TRUE(lit && lit->passage.through);
        least = least.cwiseMin(lit->x);
        most = most.cwiseMax(lit->x);
      }
      EXPECT_LT((0.5 * (least + most) - panel_middle(rig.projector)).norm(), 0.5) << board;
    }
  }
}

TEST(StationCommand, says_which_corner_lies_how_far_beyond_the_light) {
  std::mt19937_64 random(support::seed());
  const support::SteeredRig rig = support::steered_rig("mock-galvo", random);
  const model::Pose T_rig_floor{.q = Eigen::Quaterniond::Identity(), .t = {0, 0, 3.5}};
  // Far to the rig's right: there the range ends.
  const auto far = station_command(rig.projector, support::station_at("far", T_rig_floor, 3.9, 0, 0));
  ASSERT_FALSE(far);
  EXPECT_EQ(far.error().rcode, RCode::kStationOutOfReach);
  EXPECT_NE(far.error().note.find("'far'"), std::string::npos);
  EXPECT_NE(far.error().note.find("range ends"), std::string::npos) << far.error().note;
  // The light ends about 3.3 m from the middle, the station 4.15 m.
  EXPECT_GT(far.error().detail, 500);
  EXPECT_LT(far.error().detail, 1500);
  // The picture is 1.8 m wide there.
  const auto wide = station_command(rig.projector, support::station_at("wide", T_rig_floor, 0, 0, 0, {2.2, 0.4}));
  ASSERT_FALSE(wide);
  EXPECT_NE(wide.error().note.find("corner lies"), std::string::npos) << wide.error().note;
  EXPECT_GT(wide.error().detail, 150);
  EXPECT_LT(wide.error().detail, 260);
  const auto never = station_command(rig.projector, support::station_at("aside", T_rig_floor, 0, 200, 0));
  EXPECT_EQ(never.error().rcode, RCode::kStationOutOfReach);
  Station own = support::station_at("own", T_rig_floor, 0, 0, 0);
  own.command_rad = Eigen::Vector2d(0.5, 0);
  EXPECT_EQ(station_command(rig.projector, own).error().rcode, RCode::kStationOutOfReach);
  own.command_rad = Eigen::Vector2d(0.01, 0.01);
  EXPECT_EQ(valid(station_command(rig.projector, own)), *own.command_rad);
  std::printf("%s\n%s\n%s\n", far.error().note.c_str(), wide.error().note.c_str(), never.error().note.c_str());
}

}  // namespace
}  // namespace raysteer::calib::bake
