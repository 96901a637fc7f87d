// A plane is told from depth, and what too little of it costs is said before an answer is given.
#include "calib/steer/depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "calib/model/pose.hpp"
#include "hal/base/noise.hpp"
#include "tests/support/ideal_rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr double kSigma = 1e-4;  // normalised coordinates: 0.2 px at a focal length of 2000 px
constexpr int kSeeds = 40;
constexpr int kPairs = 200;

/// Two views half a metre apart of a tilted plane 3.5 m away, whose points stand off it by `relief` in parallax, one
/// standard deviation, in units of the noise.
std::vector<ViewPair> views(std::uint64_t seed, double relief, const model::Pose& T_b_a) {
  Noise noise(seed, 0xdeb);
  std::vector<ViewPair> pairs;
  for (int i = 0; i < kPairs; ++i) {
    Eigen::Vector3d p(noise.uniform(-1, 1), noise.uniform(-0.7, 0.7), 3.5);
    p.z() += 0.2 * p.x();
    p.z() += relief * noise.normal() * kSigma * p.z() * p.z() / std::max(T_b_a.t.norm(), 1e-3);
    const Eigen::Matrix2d covariance = kSigma * kSigma * Eigen::Matrix2d::Identity();
    ViewPair pair{p.hnormalized(), (T_b_a * p).hnormalized(), covariance, covariance};
    pair.a += support::ideal::normals(noise, kSigma);
    pair.b += support::ideal::normals(noise, kSigma);
    pairs.push_back(pair);
  }
  return pairs;
}

/// Of kSeeds pairs of views, how many count as flat.
int flat(double relief, double baseline_m = 0.5) {
  const model::Pose T_b_a{model::rotation_by({0.02, -0.14, 0.01}), {-baseline_m, 0, 0.03 * baseline_m}};
  const Eigen::Matrix3d F = fundamental(T_b_a.rotation(), T_b_a.t);
  int count = 0;
  for (int i = 0; i < kSeeds; ++i) {
    count += plane_or_depth(views(support::seed() + static_cast<std::uint64_t>(i), relief, T_b_a), F).flat() ? 1 : 0;
  }
  return count;
}

// -0.386 n + ln 4n with n = 200 is 3.5 of its standard deviations (sqrt 2n) below zero: one plane in 4000 is mistaken.
TEST(PlaneOrDepth, a_plane_is_flat_and_relief_is_not) {
  EXPECT_GE(flat(0), kSeeds - 2);
  EXPECT_EQ(flat(4), 0);
}

// Parallax as large as the noise is where the two are equal (Torr 2002).
TEST(PlaneOrDepth, turns_where_parallax_equals_the_noise) {
  EXPECT_GT(flat(0.4), kSeeds * 8 / 10);
  EXPECT_LT(flat(2.5), kSeeds / 10);
}

// A box in a corner: nine tenths of the points lie in one plane all the same.
TEST(PlaneOrDepth, a_tenth_of_the_points_off_the_plane_is_depth) {
  const model::Pose T_b_a{model::rotation_by({0.02, -0.14, 0.01}), {-0.5, 0, 0.015}};
  const Eigen::Matrix3d F = fundamental(T_b_a.rotation(), T_b_a.t);
  for (int i = 0; i < kSeeds; ++i) {
    const std::uint64_t seed = support::seed() + static_cast<std::uint64_t>(i);
    auto pairs = views(seed, 0, T_b_a);
    const auto box = views(seed + 1000, 30, T_b_a);
    std::copy_n(box.begin(), kPairs / 10, pairs.begin());
    EXPECT_FALSE(plane_or_depth(pairs, F).flat()) << seed;
  }
}

// A wild match is off the line of its ray too, and says neither.
TEST(PlaneOrDepth, wild_matches_are_no_depth) {
  const model::Pose T_b_a{model::rotation_by({0.02, -0.14, 0.01}), {-0.5, 0, 0.015}};
  const Eigen::Matrix3d F = fundamental(T_b_a.rotation(), T_b_a.t);
  int flat = 0;
  for (int i = 0; i < kSeeds; ++i) {
    const std::uint64_t seed = support::seed() + static_cast<std::uint64_t>(i);
    Noise noise(seed, 0x311d);
    auto pairs = views(seed, 0, T_b_a);
    for (int k = 0; k < 3 * kPairs / 100; ++k) {
      pairs[static_cast<std::size_t>(k)].b += support::ideal::normals(noise, 300 * kSigma);
    }
    flat += plane_or_depth(pairs, F).flat() ? 1 : 0;
  }
  EXPECT_GE(flat, kSeeds * 8 / 10);  // of six one falls onto its line by chance in a rig of twelve
}

TEST(PlaneOrDepth, a_turning_camera_sees_no_depth) { EXPECT_GE(flat(0, 1e-9), kSeeds - 2); }

class DepthOf : public testing::TestWithParam<const char*> {
 protected:
  /// Of the true rig's looks, as a perfect solve would judge them.
  Depth depth(bool relief, double eyes_apart = 1, double noise_px = 0.2) {
    const auto board = support::board_named(GetParam());
    support::IdealRig rig = *support::draw_ideal(board, support::seed());
    const Eigen::Vector3d centre = rig.truth.rig.cameras[1].centre();
    Eigen::Isometry3d& T = rig.truth.rig.cameras[1].T_camera_rig;
    T.translation() = -(T.linear() * (eyes_apart * centre));
    rig.cameras.devices[1].T_device_rig = support::ideal::pose_of(T);
    const auto seen = support::observe(rig, support::command_grid(rig.projector, 4, 4, 0.8),
                                       {.noise_px = noise_px, .points = 60, .relief = relief}, support::seed());
    return depth_of(seen.looks, rig.cameras);
  }
};

INSTANTIATE_TEST_SUITE_P(Boards, DepthOf, testing::Values("mock-galvo", "mock-head"));

TEST_P(DepthOf, a_bare_floor_is_refused_as_flat) {
  const Status said = check_depth(depth(false));
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().rcode, RCode::kSceneTooFlat);
}

TEST_P(DepthOf, boxes_are_depth) { EXPECT_TRUE(check_depth(depth(true))); }

TEST_P(DepthOf, eyes_in_one_place_have_too_little_parallax) {
  const Status said = check_depth(depth(true, 1e-4));
  ASSERT_FALSE(said);
  EXPECT_EQ(said.error().rcode, RCode::kTooLittleParallax);
}

}  // namespace
}  // namespace raysteer::calib::steer
