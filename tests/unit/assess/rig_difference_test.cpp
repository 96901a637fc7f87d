#include "calib/assess/rig_difference.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "calib/model/steered_parameters.hpp"
#include "hal/base/noise.hpp"
#include "tests/support/drawn_rig.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::assess {
namespace {

/// The drawn rig above a floor 3.5 m below it, in a room whose z is up.
class Difference : public testing::TestWithParam<const char*> {
 protected:
  Difference() {
    const support::DrawnRig drawn = support::drawn_rig(GetParam());
    steer::Solution& solution = rig.solution;
    solution.projector = drawn.drawing.projector;
    solution.cameras = drawn.cameras;
    const int cameras = solution.cameras.count(0) + solution.cameras.count(1);
    const int all = cameras + solution.projector_parameters();
    sigma = Eigen::VectorXd::Constant(all + 6, 2e-5);
    sigma.segment(cameras, 4).setConstant(0.1);  // px
    rig.covariance = sigma.cwiseAbs2().asDiagonal();
    solution.covariance = rig.covariance.topLeftCorner(all, all);
    solution.cameras.covariance = rig.covariance.topLeftCorner(cameras, cameras);
    rig.T_rig_room = {Eigen::Quaterniond(0, 1, 0, 0), {0.1, 0.2, 3.5}};  // half a turn about x
    const auto& projector = solution.projector;
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 5; ++j) {
        const Eigen::Vector2d share((i + 0.5) / 6, (j + 0.5) / 5);
        const Eigen::Vector2d command =
            projector.least_rad + 0.6 * share.cwiseProduct(projector.most_rad - projector.least_rad);
        for (const double x : {0.1, 0.9}) {
          places.push_back({command, {x * projector.lens.width, x * projector.lens.height}});
        }
      }
    }
  }

  steer::InRoom moved(const Eigen::VectorXd& delta) const {
    steer::InRoom other = rig;
    const int cameras = rig.solution.camera_parameters();
    other.solution.projector =
        model::perturbed(rig.solution.projector, delta.segment(cameras, rig.solution.projector_parameters()));
    other.T_rig_room = model::moved_by(rig.T_rig_room, delta.tail<6>());
    return other;
  }

  steer::InRoom rig;
  Eigen::VectorXd sigma;
  std::vector<LitPlace> places;
  steer::Surface floor{.point = {0, 0, 0}, .normal = {0, 0, 1}};
};
INSTANTIATE_TEST_SUITE_P(Boards, Difference, testing::Values("mock-galvo", "mock-head"));

TEST_P(Difference, is_none_to_itself) {
  const auto same = rig_difference(rig, rig, floor, places);
  ASSERT_TRUE(same) << same.error().message();
  EXPECT_GT(same->places.size(), 40U);
  EXPECT_EQ(same->max_mm, 0);
  EXPECT_EQ(same->beyond_chance, 0);
}

TEST_P(Difference, of_a_rig_that_was_bumped_is_the_whole_rigs) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(sigma.size());
  delta.tail<6>() << 2e-3, -1e-3, 4e-3, 4e-3, -2e-3, 2e-3;
  const auto found = rig_difference(rig, moved(delta), floor, places);
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_GT(found->mean_mm, 2);
  EXPECT_GT(found->whole_rms_mm, 2);
  EXPECT_LT(found->inside_rms_mm, 0.03 * found->whole_rms_mm);  // second order, and the prior
  EXPECT_GT(found->beyond_chance, 0.9);                         // a turn leaves some place where it was
}

TEST_P(Difference, of_a_mirror_that_steers_more_is_inside_the_rig) {
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(sigma.size());
  delta[sigma.size() - 6 - 8] = 5e-3;       // gain of axis 1
  delta[sigma.size() - 6 - 8 + 4] = -5e-3;  // of axis 2
  const auto found = rig_difference(rig, moved(delta), floor, places);
  ASSERT_TRUE(found) << found.error().message();
  EXPECT_GT(found->mean_mm, 1);
  EXPECT_GT(found->inside_rms_mm, 0.3 * found->mean_mm);
  EXPECT_GT(found->beyond_chance, 0.5);
}

TEST_P(Difference, says_where_light_falls_now_from_where_it_fell) {
  steer::InRoom before = rig;
  // The rig's frame moved by +3 mm along the room's x: light did, too.
  before.T_rig_room = rig.T_rig_room * model::Pose{Eigen::Quaterniond::Identity(), {3e-3, 0, 0}};
  const auto found = rig_difference(rig, before, floor, places);
  ASSERT_TRUE(found);
  for (const MovedPlace& place : found->places) {
    EXPECT_NEAR(1e3 * place.moved_m.x(), 3, 1e-6);
    EXPECT_NEAR(1e3 * place.moved_m.y(), 0, 1e-6);
  }
}

// Two calibrations of one rig, each off by what it says: 5 % of the places of a pair are beyond on average, though in
// one pair few or many are, since all places share the errors.
TEST_P(Difference, of_two_honest_calibrations_is_beyond_chance_in_a_twentieth) {
  Noise noise(support::seed(), 0xd1);
  const auto draw = [&] {
    Eigen::VectorXd delta(sigma.size());
    for (Eigen::Index k = 0; k < delta.size(); ++k) {
      delta[k] = sigma[k] * noise.normal();
    }
    return moved(delta);
  };
  double beyond = 0;
  constexpr int kPairs = 150;
  const std::vector<LitPlace> few(places.begin(), places.begin() + 12);
  for (int pair = 0; pair < kPairs; ++pair) {
    const auto found = rig_difference(draw(), draw(), floor, few);
    ASSERT_TRUE(found);
    beyond += found->beyond_chance / kPairs;
  }
  std::printf("%.1f %% of places beyond chance (5 %%)\n", 100 * beyond);
  // One standard deviation is below 0.018 (as if each pair were all beyond or all within).
  EXPECT_LT(beyond, 0.12);
  EXPECT_GT(beyond, 0.003);
}

TEST_P(Difference, to_another_rig_is_refused) {
  steer::InRoom other = rig;
  other.solution.projector.lens.width += 2;
  const auto panel = rig_difference(rig, other, floor, places);
  ASSERT_FALSE(panel);
  EXPECT_EQ(panel.error().rcode, RCode::kCalibrationMismatch);
  const auto nowhere = rig_difference(rig, rig, {.point = {0, 0, 9}, .normal = {0, 0, 1}}, places);
  ASSERT_FALSE(nowhere);
  EXPECT_EQ(nowhere.error().rcode, RCode::kTooFewCorrespondences);
}

}  // namespace
}  // namespace raysteer::calib::assess
