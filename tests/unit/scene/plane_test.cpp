// The wall is found among other things, and its flatness is that of small patches.
#include "calib/scene/plane.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calib/synth/noise.hpp"

namespace raysteer::calib::scene {
namespace {

/// A wall 0.1 x 0.1 m at 1 m, tilted, waving by `wave_m` over 0.1 m, noise `sigma_m` along z; every fifth point is
/// somewhere else.
std::vector<CloudPoint> wall(double sigma_m, double wave_m, std::uint64_t seed) {
  synth::Noise noise(seed);
  std::vector<CloudPoint> points;
  for (int k = 0; k < 20000; ++k) {
    CloudPoint point;
    const double x = noise.uniform(-0.05, 0.05);
    const double y = noise.uniform(-0.05, 0.05);
    const double z = 1 + 0.2 * x + wave_m * std::sin(2 * M_PI * x / 0.1) + sigma_m * noise.normal();
    point.p = k % 5 == 0 ? Eigen::Vector3d(x, y, noise.uniform(0.5, 0.9)) : Eigen::Vector3d(x, y, z);
    point.covariance = sigma_m * sigma_m * Eigen::Vector3d(0, 0, 1).asDiagonal();
    points.push_back(point);
  }
  return points;
}

TEST(Plane, finds_the_wall_with_its_covariance) {
  const std::vector<CloudPoint> points = wall(0.0005, 0, 1);
  const auto plane = dominant_plane(points, 0.005);
  ASSERT_TRUE(plane);
  const Eigen::Vector3d truth = Eigen::Vector3d(0.2, 0, -1).normalized();
  const double tilt = std::acos(std::min(1.0, plane->normal.dot(truth)));
  EXPECT_LT(tilt, 5 * std::sqrt(plane->covariance(0, 0) + plane->covariance(1, 1)));
  EXPECT_NEAR(plane->rms_m, 0.0005 / std::sqrt(1.04), 2e-5);
  EXPECT_NEAR(static_cast<double>(plane->inliers), 16000, 200);
}

TEST(Plane, flatness_is_the_noise_not_the_wave) {
  const std::vector<CloudPoint> points = wall(0.0003, 0.001, 2);
  const auto plane = dominant_plane(points, 0.006);
  ASSERT_TRUE(plane);
  const auto flat = flatness(points, *plane);
  ASSERT_TRUE(flat);
  EXPECT_GT(plane->rms_m, 0.0005);
  EXPECT_NEAR(flat->patch_rms_m, 0.0003 / std::sqrt(1.04), 4e-5);
  EXPECT_NEAR(flat->predicted_rms_m, 0.0003 / std::sqrt(1.04), 2e-5);
  EXPECT_GT(flat->patches, 60U);
  EXPECT_LT(flat->trimmed, 0.01);
}

TEST(Plane, too_few_points_are_an_error) {
  std::vector<CloudPoint> points = wall(0.0003, 0, 2);
  points.resize(50);
  const auto plane = dominant_plane(points, 0.006);
  ASSERT_FALSE(plane);
  EXPECT_EQ(plane.error().rcode, RCode::kTooFewMatches);
}

}  // namespace
}  // namespace raysteer::calib::scene
