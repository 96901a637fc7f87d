// A pair that moved is found and put right; one at rest is left in peace.
#include "calib/scene/refit_pose.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/scene/wall_pair.hpp"

namespace raysteer::calib::scene {
namespace {

/// As calibrate leaves it: focal length 1 px, centre 1.5 px, rotation 0.2 mrad, translation 0.1 mm.
model::Rig uncertain(model::Rig rig) {
  int total = 0;
  for (std::size_t k = 0; k < rig.devices.size(); ++k) {
    total += rig.count(k);
  }
  rig.covariance = Eigen::MatrixXd::Zero(total, total);
  for (std::size_t k = 0; k < rig.devices.size(); ++k) {
    Eigen::VectorXd sigma = Eigen::VectorXd::Zero(rig.count(k));
    sigma.head<4>() << 1, 1, 1.5, 1.5;
    if (k > 0) {
      sigma.tail<6>() << 2e-4, 2e-4, 2e-4, 1e-4, 1e-4, 1e-4;
    }
    rig.covariance.block(rig.offset(k), rig.offset(k), rig.count(k), rig.count(k)) =
        Eigen::MatrixXd(sigma.cwiseAbs2().asDiagonal());
  }
  return rig;
}

/// What the rig may be in truth, when it is only known with its covariance.
model::Rig drawn(const model::Rig& rig, std::uint64_t seed) {
  synth::Noise noise(seed);
  model::Rig truth;
  truth.devices = rig.devices;
  for (std::size_t k = 0; k < rig.devices.size(); ++k) {
    Eigen::VectorXd delta = Eigen::VectorXd::Zero(rig.count(k));
    for (int p = 0; p < rig.count(k); ++p) {
      delta[p] = std::sqrt(rig.covariance(rig.offset(k) + p, rig.offset(k) + p)) * noise.normal();
    }
    truth.devices[k] = model::perturbed(rig.devices[k], delta, k > 0);
  }
  return truth;
}

Result<PoseRefit> refit(const model::Rig& rig, const std::vector<Match>& matches) {
  const TwoViews views = *two_views(rig, 0, 1);
  return refit_pose(rig, 0, 1, matches, ray_pairs(views, matches));
}

TEST(RefitPose, a_healthy_pair_raises_no_alarm) {
  const model::Rig rig = uncertain(pair_rig());
  double chi_squares = 0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 100; seed < 100 + kSeeds; ++seed) {
    const auto found = refit(rig, wall_pair(drawn(rig, seed), 60, 45, 0.1, seed).matches);
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_FALSE(found->moved) << "seed " << seed << " chi-square " << found->chi_square;
    chi_squares += found->chi_square;
  }
  // Mean of chi-square with 5 degrees of freedom over 20 draws: 5 +- 0.7.
  EXPECT_GT(chi_squares / kSeeds, 2);
  EXPECT_LT(chi_squares / kSeeds, 9);
}

TEST(RefitPose, a_moved_pair_is_named_and_the_turn_found) {
  const model::Rig rig = uncertain(pair_rig());
  for (std::uint64_t seed = 200; seed < 210; ++seed) {
    synth::Noise noise(seed);
    const Eigen::Vector3d turn = 7e-3 * Eigen::Vector3d(noise.normal(), noise.normal(), noise.normal()).normalized();
    const auto found = refit(rig, wall_pair(turned(rig, turn), 60, 45, 0.1, seed).matches);
    ASSERT_TRUE(found) << found.error().message();
    EXPECT_TRUE(found->moved) << "seed " << seed << " chi-square " << found->chi_square;
    EXPECT_LT(std::abs(found->moved_rad - 7e-3), 5 * found->moved_sigma_rad) << "seed " << seed;
    EXPECT_LT(found->held_out_after_px, 1.1 * 0.1 * std::sqrt(2.0)) << "seed " << seed;
    EXPECT_GT(found->held_out_before_px, found->held_out_after_px) << "seed " << seed;
    EXPECT_NEAR(found->T_right_left.t.norm(), rig.devices[1].T_device_rig.t.norm(), 1e-12);
  }
}

TEST(RefitPose, states_an_uncertainty_that_covers_its_error) {
  // 5 numbers a refit, 20 refits: the normalised error squared has mean 5.
  const model::Rig rig = pair_rig();
  double normalised = 0;
  constexpr int kSeeds = 20;
  for (std::uint64_t seed = 300; seed < 300 + kSeeds; ++seed) {
    const auto found = refit(rig, wall_pair(rig, 60, 45, 0.1, seed).matches);
    ASSERT_TRUE(found);
    normalised += found->chi_square / kSeeds;  // against the truth: the calibration is exact here
  }
  EXPECT_GT(normalised, 2);
  EXPECT_LT(normalised, 12);
}

TEST(RefitPose, survives_a_tenth_of_wrong_matches) {
  const model::Rig rig = pair_rig();
  WallPair pair = wall_pair(turned(rig, {0.004, 0.003, -0.002}), 60, 45, 0.1, 5);
  synth::Noise noise(6);
  for (std::size_t k = 0; k < pair.matches.size(); k += 10) {
    pair.matches[k].q_right += Eigen::Vector2d(noise.uniform(-40, 40), noise.uniform(-40, 40));
  }
  const auto found = refit(rig, pair.matches);
  ASSERT_TRUE(found);
  EXPECT_LT(found->held_out_after_px, 0.2);
}

TEST(RefitPose, needs_matches) {
  const WallPair pair = wall_pair(pair_rig(), 10, 10, 0.1, 1);
  const auto found = refit(pair.rig, pair.matches);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().rcode, RCode::kTooFewMatches);
}

}  // namespace
}  // namespace raysteer::calib::scene
