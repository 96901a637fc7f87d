#include "calib/assess/assess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calib/assess/maps.hpp"
#include "calib/solve/solve.hpp"
#include "tests/support/solver_case.hpp"

namespace raysteer::calib::assess {
namespace {

using support::Devices;
using support::solver_case;

solve::SolveOptions bc4() {
  solve::SolveOptions options;
  options.lens = model::LensModel::kBc4;
  return options;
}

TEST(Assess, held_out_corners_are_missed_by_little_more_than_the_noise) {
  const auto known = solver_case(Devices::kStereo, 5);
  const auto solution = solve::solve(known.observations, bc4());
  ASSERT_TRUE(solution);
  const auto assessment = assess(known.observations, *solution);
  ASSERT_TRUE(assessment) << assessment.error().message();
  const CrossValidation& cross = assessment->cross_validation;
  // 0.1 px per coordinate: 0.141 px RMS, 0.245 px at 95 %; the pose from half of the corners adds a little.
  EXPECT_NEAR(cross.rms_px, 0.15, 0.02);
  EXPECT_NEAR(cross.p95_px, 0.26, 0.03);
  EXPECT_LT(assessment->devices[0].odd_even_p95_px, 2);
  EXPECT_EQ(assessment->devices[0].coverage.corners.values.size(), 20U);
  EXPECT_GT(assessment->devices[0].coverage.tilt_x_rad, 0.3);
  EXPECT_FALSE(assessment->summary.empty());
}

TEST(Assess, a_projectors_left_out_poses_are_hit) {
  const auto known = solver_case(Devices::kProjector, 6, 6);
  const auto solution = solve::solve(known.observations, bc4());
  ASSERT_TRUE(solution);
  const auto assessment = assess(known.observations, *solution);
  ASSERT_TRUE(assessment) << assessment.error().message();
  EXPECT_GT(assessment->cross_validation.leave_one_out_px, 0.02);
  EXPECT_LT(assessment->cross_validation.leave_one_out_px, 0.3);
}

TEST(Assess, noisy_views_are_to_be_done_again_with_advice) {
  const auto known = solver_case(Devices::kMono, 7, 8, 1.0);
  const auto solution = solve::solve(known.observations, bc4());
  ASSERT_TRUE(solution) << solution.error().message();
  const auto assessment = assess(known.observations, *solution);
  ASSERT_TRUE(assessment);
  EXPECT_EQ(assessment->verdict, Verdict::kRedo);
  EXPECT_FALSE(assessment->reasons.empty());
  EXPECT_FALSE(assessment->advice.empty());
}

TEST(Assess, the_same_calibration_twice_differs_by_nothing) {
  const auto known = solver_case(Devices::kMono, 8);
  const auto solution = solve::solve(known.observations, bc4());
  ASSERT_TRUE(solution);
  AssessOptions options;
  options.previous = &solution->rig;
  const auto assessment = assess(known.observations, *solution, options);
  ASSERT_TRUE(assessment);
  ASSERT_EQ(assessment->differences.size(), 1U);
  EXPECT_LT(assessment->differences[0].p95_px, 1e-6);
}

TEST(Maps, a_turned_principal_point_is_a_rotation_but_for_second_order) {
  const model::Camera camera = support::solver_rig(Devices::kMono, 1).devices[0].camera;
  model::Camera other = camera;
  other.cx += 2;
  const double left = quantile(difference_map(camera, other), 0.95);
  EXPECT_GT(left, 0.01);
  EXPECT_LT(left, 1.0);
  other = camera;
  other.fx *= 1.01;
  other.fy *= 1.01;
  EXPECT_GT(quantile(difference_map(camera, other), 0.95), 2);
}

TEST(Maps, uncertainty_agrees_with_the_scatter_of_resampled_calibrations) {
  // Two-dimensional check of the linear map: sample intrinsics from the covariance, take out the best motion by the
  // same linear algebra's definition, compare the spread at one cell.
  const auto known = solver_case(Devices::kMono, 9);
  const auto solution = solve::solve(known.observations, bc4());
  ASSERT_TRUE(solution);
  const model::Device& device = solution->rig.devices[0];
  const double infinity = std::numeric_limits<double>::infinity();
  const GridMap map = uncertainty_map(device.camera, solution->rig.covariance, infinity, infinity);
  synth::Noise noise(3);
  const Eigen::MatrixXd root = solution->rig.covariance.llt().matrixL();
  constexpr int kSamples = 400;
  GridMap squares = map;
  std::fill(squares.values.begin(), squares.values.end(), 0);
  for (int i = 0; i < kSamples; ++i) {
    Eigen::VectorXd z(root.rows());
    for (double& number : z) {
      number = noise.normal();
    }
    const GridMap difference = difference_map(device.camera, perturbed(device, root * z, false).camera);
    for (std::size_t c = 0; c < squares.values.size(); ++c) {
      squares.values[c] += difference.values[c] * difference.values[c] / kSamples;
    }
  }
  for (std::size_t c = 0; c < squares.values.size(); ++c) {
    // The map's sigma is that of the larger axis: the length's RMS lies between one and sqrt(2) of it.
    const double rms = std::sqrt(squares.values[c]);
    EXPECT_GT(rms, 0.85 * map.values[c]) << c;
    EXPECT_LT(rms, 1.15 * std::sqrt(2.0) * map.values[c]) << c;
  }
}

}  // namespace
}  // namespace raysteer::calib::assess
