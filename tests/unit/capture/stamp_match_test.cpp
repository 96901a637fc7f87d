#include "firmware/capture/stamp_match.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace raysteer::firmware::capture {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

RigTime rig(int ms) { return RigTime(milliseconds(ms)); }
CameraTime camera(int ms, int us = 0) { return CameraTime(milliseconds(1'000'000 + ms) + microseconds(us)); }

const std::vector<RigTime> kEdges{rig(100), rig(162), rig(273), rig(335), rig(397), rig(508)};

TEST(StampMatch, learns_what_lies_between_the_clocks) {
  StampMatch match;
  EXPECT_TRUE(
      match.learn(kEdges, std::vector{camera(100), camera(162), camera(273), camera(335), camera(397), camera(508)}));
  EXPECT_LT(std::chrono::abs(match.to_rig(camera(700)) - rig(700)), milliseconds(1));
}

TEST(StampMatch, is_not_misled_by_frames_nobody_triggered_nor_by_lost_ones) {
  StampMatch match;
  EXPECT_TRUE(
      match.learn(kEdges, std::vector{camera(40), camera(51), camera(162), camera(273), camera(397), camera(508)}));
  EXPECT_LT(std::chrono::abs(match.to_rig(camera(700)) - rig(700)), milliseconds(1));
}

TEST(StampMatch, learns_nothing_from_cameras_that_run_free) {
  StampMatch match;
  EXPECT_FALSE(match.learn(kEdges, std::vector{camera(17), camera(33), camera(50)}));
  EXPECT_FALSE(match.known());
}

TEST(StampMatch, follows_a_drift_and_allows_for_it_when_long_unseen) {
  StampMatch match;
  ASSERT_TRUE(
      match.learn(kEdges, std::vector{camera(100), camera(162), camera(273), camera(335), camera(397), camera(508)}));
  match.follow(rig(10'000), camera(10'000, 800));
  EXPECT_EQ(match.to_rig(camera(10'000, 800)), rig(10'000));
  EXPECT_EQ(match.tolerance(rig(10'000)), milliseconds(1));
  EXPECT_EQ(match.tolerance(rig(310'000)), milliseconds(31));
}

}  // namespace
}  // namespace raysteer::firmware::capture
