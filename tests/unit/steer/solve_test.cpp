#include "calib/steer/solve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/ideal_rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::calib::steer {
namespace {

class Solve : public testing::TestWithParam<const char*> {
 protected:
  proto::board::Board board = support::board_named(GetParam());
  Drawing drawing = support::drawing_of(board);
  std::uint64_t seed = support::seed();
  support::IdealRig rig = *support::draw_ideal(board, seed);

  Observations observe(const support::IdealOptions& options = {.points = 60}) const {
    return support::observe(rig, support::command_grid(rig.projector, 4, 4, 0.8), options, seed);
  }
};

// A true model's whitened RMS scatters by 1 / sqrt(2 n): with n = 2880, 6 of those are 0.08.
TEST_P(Solve, explains_a_rig_that_is_off_its_drawing_by_its_tolerances) {
  const auto solution = solve(observe(), drawing);
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_NEAR(solution->whitened_rms, 1, 0.08);
  EXPECT_LT(solution->dropped, 10U);
  EXPECT_EQ(solution->looks.size(), 16U);
  EXPECT_EQ(solution->covariance.rows(), static_cast<Eigen::Index>(solution->parameters.size()));
  EXPECT_GT(solution->covariance.diagonal().minCoeff(), 0);
}

TEST_P(Solve, is_the_same_twice) {
  const Observations observations = observe();
  const auto a = solve(observations, drawing);
  const auto b = solve(observations, drawing);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->covariance, b->covariance);
  EXPECT_EQ(a->projector.T_projector_rig.t, b->projector.T_projector_rig.t);
}

INSTANTIATE_TEST_SUITE_P(Boards, Solve, testing::Values("mock-galvo", "mock-head"));

}  // namespace
}  // namespace raysteer::calib::steer
