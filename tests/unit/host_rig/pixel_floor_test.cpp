// How much pixels scatter beyond what is stated, from what two eyes say of each other.
#include "host/rig/pixel_floor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "calib/scene/two_views.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::host::rig {
namespace {

using calib::scene::Match;
using calib::scene::TwoViews;

constexpr double kStated = 0.005;

TwoViews eyes() {
  const calib::model::Camera lens{
      .width = 612, .height = 512, .fx = 350, .fy = 350, .cx = 305.5, .cy = 255.5, .k = {-0.03, 0, 0, 0}};
  TwoViews views{lens, lens, {}};
  views.T_right_left.t = {-0.5, 0, 0};
  return views;
}

/// Points of a floor with steps, seen with `noise_px` in each coordinate and stated as `kStated`; every 20th is of
/// another surface.
std::vector<Match> matches(const TwoViews& views, double noise_px, int count, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, noise_px);
  std::uniform_real_distribution<double> any(-1, 1);
  std::vector<Match> all;
  while (static_cast<int>(all.size()) < count) {
    const Eigen::Vector3d p(1.5 * any(random), 1.5 * any(random), any(random) > 0 ? 3.5 : 3.1);
    Match match;
    match.q_left = *views.left.project(p) + Eigen::Vector2d(normal(random), normal(random));
    match.q_right = *views.right.project(views.T_right_left * p) + Eigen::Vector2d(normal(random), normal(random));
    match.q_right.y() += all.size() % 20 == 0 ? 0.7 : 0;
    match.cov_left = match.cov_right = kStated * kStated * Eigen::Matrix2d::Identity();
    all.push_back(match);
  }
  return all;
}

TEST(PixelFloor, is_what_the_eyes_disagree_in_beyond_what_is_stated) {
  std::mt19937_64 random(support::seed());
  const TwoViews truth = eyes();
  for (const double more : {0.01, 0.05}) {
    const auto seen = matches(truth, std::hypot(kStated, more), 3000, random);
    EXPECT_NEAR(pixel_floor(truth, seen), more, 0.15 * more);
    // Poses and lenses a little off, as a calibration leaves them, are no noise.
    TwoViews off = truth;
    off.T_right_left.q = calib::model::rotation_by({3e-4, -2e-4, 4e-4});
    off.right.fx += 0.2;
    EXPECT_NEAR(pixel_floor(off, seen), more, 0.15 * more);
  }
}

TEST(PixelFloor, is_next_to_nothing_where_pixels_are_as_sure_as_stated) {
  std::mt19937_64 random(support::seed());
  const TwoViews views = eyes();
  EXPECT_LT(pixel_floor(views, matches(views, 0.8 * kStated, 3000, random)), 0.0021);
  EXPECT_LT(pixel_floor(views, matches(views, kStated, 3000, random)), 0.5 * kStated);
}

TEST(PixelFloor, is_cautious_where_few_matches_say_so) {
  std::mt19937_64 random(support::seed());
  const TwoViews views = eyes();
  EXPECT_EQ(pixel_floor(views, matches(views, kStated, 49, random)), 0.02);
  EXPECT_EQ(pixel_floor(views, {}), 0.02);
}

}  // namespace
}  // namespace raysteer::host::rig
