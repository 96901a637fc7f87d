// The disagreement of a pair is measured in rectified rows, and split into noise and system.
#include "calib/scene/epipolar.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scene/wall_pair.hpp"

namespace raysteer::calib::scene {
namespace {

TEST(Epipolar, exact_matches_agree) {
  const WallPair pair = wall_pair(pair_rig(), 40, 30, 0, 1);
  const TwoViews views = *two_views(pair.rig, 0, 1);
  for (const double d : epipolar_disagreement(views, ray_pairs(views, pair.matches))) {
    EXPECT_NEAR(d, 0, 1e-8);
  }
}

TEST(Epipolar, is_the_difference_of_rows_of_a_rectified_pair) {
  model::Rig rig = pair_rig();
  for (model::Device& device : rig.devices) {
    device.camera.k = {};
  }
  rig.devices[1].T_device_rig = {Eigen::Quaterniond::Identity(), Eigen::Vector3d(-0.1, 0, 0)};
  WallPair pair = wall_pair(rig, 10, 10, 0, 1);
  for (Match& match : pair.matches) {
    match.q_right.y() += 0.7;
  }
  const TwoViews views = *two_views(rig, 0, 1);
  for (const double d : epipolar_disagreement(views, ray_pairs(views, pair.matches))) {
    EXPECT_NEAR(std::abs(d), 0.7, 1e-6);
  }
}

TEST(Epipolar, tells_noise_within_a_cell_from_a_pair_that_is_turned) {
  // Rolled by 1 mrad: rows differ by 0.6 px at the sides and agree in the middle.
  WallPair pair = wall_pair(turned(pair_rig(), {0, 0, 0.001}), 200, 150, 0.1, 7);
  const TwoViews calibrated = *two_views(pair_rig(), 0, 1);
  const std::vector<double> d = epipolar_disagreement(calibrated, ray_pairs(calibrated, pair.matches));
  const auto analysis = analyse_epipolar(pair.matches, d);
  ASSERT_TRUE(analysis);
  const double noise = 0.1 * std::sqrt(2.0);
  EXPECT_NEAR(analysis->within_cell_px, noise, 0.05 * noise);
  EXPECT_NEAR(analysis->systematic_px, 0.3, 0.1);
  EXPECT_GT(analysis->sigma_px, 1.5 * analysis->within_cell_px);
}

TEST(Epipolar, finds_no_system_in_a_pair_at_rest) {
  const WallPair pair = wall_pair(pair_rig(), 200, 150, 0.1, 8);
  const TwoViews views = *two_views(pair.rig, 0, 1);
  const auto analysis = analyse_epipolar(pair.matches, epipolar_disagreement(views, ray_pairs(views, pair.matches)));
  ASSERT_TRUE(analysis);
  EXPECT_NEAR(analysis->sigma_px, analysis->within_cell_px, 0.03 * analysis->sigma_px);
  EXPECT_LT(analysis->systematic_px, 0.05);
}

TEST(Epipolar, needs_a_hundred_matches) {
  const WallPair pair = wall_pair(pair_rig(), 9, 9, 0.1, 1);
  const std::vector<double> d(pair.matches.size(), 0.0);
  const auto analysis = analyse_epipolar(pair.matches, d);
  ASSERT_FALSE(analysis);
  EXPECT_EQ(analysis.error().rcode, RCode::kTooFewMatches);
}

}  // namespace
}  // namespace raysteer::calib::scene
