// Points lie where the light was, within the covariance they carry; wrong matches do not become points.
#include "calib/scene/triangulate.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scene/wall_pair.hpp"

namespace raysteer::calib::scene {
namespace {

TEST(Triangulate, exact_matches_give_exact_points) {
  const WallPair pair = wall_pair(pair_rig(), 60, 45, 0, 1);
  const TwoViews views = *two_views(pair.rig, 0, 1);
  const auto cloud = triangulate(views, pair.matches, ray_pairs(views, pair.matches));
  ASSERT_TRUE(cloud) << cloud.error().message();
  EXPECT_EQ(cloud->points.size(), pair.matches.size());
  for (const CloudPoint& point : cloud->points) {
    EXPECT_LT((point.p - pair.truth[point.match]).norm(), 1e-8);
  }
}

TEST(Triangulate, covariance_is_that_of_the_error) {
  WallPair pair = wall_pair(pair_rig(), 80, 60, 0.1, 3);
  const TwoViews views = *two_views(pair.rig, 0, 1);
  // Unequal noise in the two views, so that the weighting is tested too.
  synth::Noise noise(4);
  for (Match& match : pair.matches) {
    match.q_right += 0.3 * Eigen::Vector2d(noise.normal(), noise.normal());
    match.cov_right += 0.09 * Eigen::Matrix2d::Identity();
  }
  const auto cloud = triangulate(views, pair.matches, ray_pairs(views, pair.matches));
  ASSERT_TRUE(cloud);
  double normalised = 0;
  for (const CloudPoint& point : cloud->points) {
    const Eigen::Vector3d miss = point.p - pair.truth[point.match];
    normalised += miss.dot(point.covariance.ldlt().solve(miss));
  }
  // Mean of chi-square with 3 degrees of freedom over 4800 points: 3 +- 0.035 (five sigma: 0.18).
  EXPECT_NEAR(normalised / static_cast<double>(cloud->points.size()), 3, 0.18);
}

TEST(Triangulate, a_projector_counts_as_a_view_without_noise) {
  WallPair pair = wall_pair(pair_rig(), 80, 60, 0, 3);
  synth::Noise noise(9);
  for (Match& match : pair.matches) {
    match.q_left += 0.2 * Eigen::Vector2d(noise.normal(), noise.normal());
    match.cov_left = 0.04 * Eigen::Matrix2d::Identity();
    match.cov_right.setZero();
  }
  const TwoViews views = *two_views(pair.rig, 0, 1);
  const auto cloud = triangulate(views, pair.matches, ray_pairs(views, pair.matches));
  ASSERT_TRUE(cloud);
  double normalised = 0;
  for (const CloudPoint& point : cloud->points) {
    const double miss = point.p.z() - pair.truth[point.match].z();
    normalised += miss * miss / point.covariance(2, 2);
  }
  EXPECT_NEAR(normalised / static_cast<double>(cloud->points.size()), 1, 0.1);
}

TEST(Triangulate, wrong_matches_are_left_out) {
  WallPair pair = wall_pair(pair_rig(), 60, 45, 0.05, 5);
  synth::Noise noise(6);
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < pair.matches.size(); k += 10) {
    pair.matches[k].q_right += Eigen::Vector2d(noise.uniform(30, 60), noise.uniform(-1, 1));  // along the line
    pair.matches[k].cov_right = Eigen::Matrix2d::Identity();
    ++wrong;
  }
  const TwoViews views = *two_views(pair.rig, 0, 1);
  const auto cloud = triangulate(views, pair.matches, ray_pairs(views, pair.matches));
  ASSERT_TRUE(cloud);
  std::size_t kept = 0;
  for (const CloudPoint& point : cloud->points) {
    kept += (point.p - pair.truth[point.match]).norm() > 0.05 ? 1 : 0;
  }
  EXPECT_LT(kept, wrong / 20);
  EXPECT_GT(cloud->rejected.isolated + cloud->rejected.epipolar, wrong * 19 / 20);
}

TEST(Triangulate, exchanged_views_leave_nothing) {
  WallPair pair = wall_pair(pair_rig(), 60, 45, 0.05, 5);
  for (Match& match : pair.matches) {
    std::swap(match.q_left, match.q_right);
  }
  const TwoViews views = *two_views(pair.rig, 0, 1);
  const auto cloud = triangulate(views, pair.matches, ray_pairs(views, pair.matches));
  ASSERT_FALSE(cloud);
  EXPECT_EQ(cloud.error().rcode, RCode::kTooFewMatches);
}

}  // namespace
}  // namespace raysteer::calib::scene
