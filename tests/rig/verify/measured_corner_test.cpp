// What 'raysteer verify' says a corner is off by, and how sure it is of that, against where the light truly fell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "calib/assess/on_surface.hpp"
#include "host/rig/verify.hpp"
#include "tests/support/drawn_rig.hpp"
#include "tests/support/floor_task.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::host::rig {
namespace {

using support::kFloorDepth;

/// A rectangle on the floor at a random place within reach.
AimedStation station_of(const support::IdealRig& rig, const calib::steer::InRoom& room, Noise& noise) {
  AimedStation station;
  station.station.name = "somewhere";
  const Eigen::Vector2d share(noise.uniform(-0.5, 0.5), noise.uniform(-0.5, 0.5));
  const auto& projector = rig.projector;
  const Eigen::Vector2d command = (projector.least_rad + projector.most_rad) / 2 +
                                  share.cwiseProduct(projector.most_rad - projector.least_rad) * 0.6;
  station.station.command_rad = command;
  station.normals_room.fill(-Eigen::Vector3d::UnitZ());
  station.sights_room.fill(Eigen::Vector3d::UnitZ());
  const auto view = projector.at(command);
  const Eigen::Vector2d middle((projector.lens.width - 1) / 2.0, (projector.lens.height - 1) / 2.0);
  const Eigen::Vector3d ray = *view.ray(middle);
  const Eigen::Vector3d p = view.centre() + (kFloorDepth - view.centre().z()) / ray.z() * ray;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d sign(k == 0 || k == 3 ? -0.5 : 0.5, k < 2 ? -0.5 : 0.5);
    station.corners_room[k] = {p.x() + 0.4 * sign.x(), p.y() + 0.25 * sign.y(), kFloorDepth};
  }
  const auto bounds = calib::assess::corner_bounds(room, command, station.corners_room, station.normals_room[0]);
  for (std::size_t k = 0; k < 4 && bounds; ++k) {
    station.panel[k] = (*bounds)[k].x;
  }
  return station;
}

class Verified : public testing::TestWithParam<const char*> {
 protected:
  proto::board::Board board = support::board_named(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Boards, Verified, testing::Values("mock-galvo", "mock-head"));

// Corners of one rig share its cameras and its tie, so that rigs are what counts: of 200, with one standard deviation
// of 1.5 %, fewer than 89 % are inside once in 10^4 runs where 95 % are.
TEST_P(Verified, corners_are_as_sure_as_stated) {
  constexpr int kRigs = 200;
  const std::uint64_t first = support::seed();
  int corners = 0, sure = 0, bounded = 0;
  double normalised = 0;
  std::vector<double> width;
  for (int k = 0; k < kRigs; ++k) {
    const std::uint64_t seed = first + static_cast<std::uint64_t>(k);
    const auto rig = support::draw_ideal(board, seed);
    ASSERT_TRUE(rig) << rig.error().message();
    Noise noise(seed, 0x7e);
    const auto room = support::tied_to_room(*rig, support::solution_of(*rig, seed), {}, noise);
    ASSERT_TRUE(room);
    const AimedStation station = station_of(*rig, *room, noise);
    std::vector<Eigen::Vector2d> latents;
    const std::vector commands{*station.station.command_rad};
    const auto seen = support::observe(*rig, commands, {.points = 500, .relief = false}, seed, &latents, 5);
    const auto verified = verify_station(*room, station, seen.looks[0]);
    if (!verified) {
      continue;  // out of the cameras' sight
    }
    const Eigen::Vector2d angles = rig->projector.angles(commands[0]) + latents[0];
    const sim::optics::LightPath light(rig->truth.rig, {Radians(angles.x()), Radians(angles.y())});
    const Eigen::Vector3d right = (station.corners_room[1] - station.corners_room[0]).normalized();
    const Eigen::Vector3d down = (station.corners_room[3] - station.corners_room[0]).normalized();
    for (std::size_t c = 0; c < 4; ++c) {
      const auto out = light.leave(station.panel[c]);
      if (!out) {
        continue;
      }
      const Eigen::Vector3d lit = out->origin + (kFloorDepth - out->origin.z()) / out->direction.z() * out->direction;
      const Eigen::Vector3d off = 1e3 * (lit - station.corners_room[c]);
      const Eigen::Vector2d truth(right.dot(off), down.dot(off));
      const double missed = (verified->off_mm[c] - truth).norm();
      ++corners;
      sure += missed <= verified->sure_mm[c] ? 1 : 0;
      bounded += truth.norm() <= verified->corner_mm[c] + verified->sure_mm[c] ? 1 : 0;
      normalised += missed * missed / (verified->sure_mm[c] * verified->sure_mm[c]);
      width.push_back(verified->sure_mm[c]);
      // What the verdict goes by is no smaller than what any corner may be off by.
      EXPECT_GE(verified->bound_95_mm, verified->corner_mm[c] + verified->sure_mm[c]);
    }
  }
  ASSERT_GT(corners, 300);
  std::ranges::nth_element(width, width.begin() + static_cast<std::ptrdiff_t>(width.size() / 2));
  std::printf(
      "%d corners: %.1f %% within what is stated (95 %%), upper bound holds for %.1f %%; sure to %.2f mm "
      "(median); %.3f of the stated square\n",
      corners, 100.0 * sure / corners, 100.0 * bounded / corners, width[width.size() / 2], normalised / corners);
  EXPECT_GT(static_cast<double>(sure) / corners, 0.89);
  EXPECT_LT(static_cast<double>(sure) / corners, 0.995);
  EXPECT_GT(static_cast<double>(bounded) / corners, 0.93);
  EXPECT_LT(width[width.size() / 2], 2);
}

TEST_P(Verified, the_bound_and_not_the_measured_error_is_compared_with_the_tolerance) {
  VerifiedStation station;
  station.error_mm = 1.3;
  station.bound_95_mm = 1.5;
  EXPECT_TRUE(station.within(1.5));
  EXPECT_FALSE(station.within(1.4));
  EXPECT_TRUE(station.within(0));  // none asked
}

TEST_P(Verified, a_station_that_few_points_fall_on_is_not_judged) {
  const std::uint64_t seed = support::seed();
  const auto rig = support::draw_ideal(board, seed);
  Noise noise(seed, 0x7e);
  const auto room = support::tied_to_room(*rig, support::solution_of(*rig, seed), {}, noise);
  ASSERT_TRUE(room);
  AimedStation station = station_of(*rig, *room, noise);
  const std::vector commands{*station.station.command_rad};
  auto seen = support::observe(*rig, commands, {.points = 200, .relief = false}, seed);
  for (Eigen::Vector3d& corner : station.corners_room) {
    corner.z() -= 0.1;  // its plane is above the floor that was lit
  }
  const auto above = verify_station(*room, station, seen.looks[0]);
  ASSERT_FALSE(above);
  EXPECT_EQ(above.error().rcode, RCode::kTooFewCorrespondences);
}

}  // namespace
}  // namespace raysteer::host::rig
