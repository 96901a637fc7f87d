// What calibrating without any board promises, held against ideal rigs whose truth is known; tools/campaign
// self_calibration does so with 200 a board.
#include "tests/support/without_board.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "tests/support/seed.hpp"

namespace raysteer::support {
namespace {

class WithoutBoardOf : public testing::TestWithParam<const char*> {
 protected:
  PlannedBoard board = planned_board(GetParam(), 25);

  WithoutBoard many(const IdealOptions& observed, int rigs) const {
    const auto found =
        many_without_board(board, seed(), {.rigs = rigs, .observed = observed, .unseen_looks = 5, .threads = 1});
    std::printf("%s: %d solved", GetParam(), found.solved);
    for (const auto& [code, count] : found.refused) {
      std::printf(", %s %d", code.c_str(), count);
    }
    std::printf("\n");
    return found;
  }
};

INSTANTIATE_TEST_SUITE_P(Boards, WithoutBoardOf, testing::Values("mock-galvo", "mock-head"));

TEST_P(WithoutBoardOf, cameras_projector_and_unseen_looks_come_out_of_relief) {
  const auto found = many({.points = 45, .drawn_cameras = true}, 2);
  EXPECT_EQ(found.refusals(), 0);
  ASSERT_GT(found.solved, 0);
  // No wrong minimum: five stated standard deviations are for one camera in a million.
  for (std::size_t i = 0; i < found.camera_focal.size(); ++i) {
    EXPECT_LT(std::abs(found.focal_normalised[i]), 5);
    EXPECT_LT(found.camera_focal[i], 0.01);
  }
  // Of two rigs; over many the median is below 0.1 %.
  EXPECT_LT(quantile(found.camera_focal, 0.5), 2e-3);
  EXPECT_LT(quantile(found.projector_focal, 0.5), 2e-3);
  EXPECT_LT(quantile(found.unseen.px, 0.95), 0.6);
}

TEST_P(WithoutBoardOf, a_bare_floor_is_too_flat) {
  const auto found = many({.points = 25, .relief = false, .drawn_cameras = true}, 1);
  EXPECT_EQ(found.refusals("R0908"), 1);
}

TEST_P(WithoutBoardOf, a_length_that_is_none_is_refused) {
  const IdealRig rig = *draw_ideal(board.drawn.board, seed());
  auto seen = observe(rig, board.commands, {.points = 25}, seed());
  seen.cameras = board.drawn.cameras;
  const auto code = [&](double metres, double sigma_m) {
    const auto solution = calib::steer::solve_without_board(
        seen, board.drawn.drawing, calib::steer::KnownLength{.metres = metres, .sigma_m = sigma_m, .ends = {}});
    return solution ? std::optional<RCode>() : solution.error().rcode;
  };
  EXPECT_EQ(code(0, 1e-3), RCode::kBadValue);
  EXPECT_EQ(code(-1, 1e-3), RCode::kBadValue);
  EXPECT_EQ(code(0.5, 0), RCode::kBadValue);
  EXPECT_EQ(code(std::nan(""), 1e-3), RCode::kNotFinite);
  EXPECT_EQ(code(0.5, std::nan("")), RCode::kNotFinite);
}

// Both eyes at one place: whatever the scene, nothing shows depth.
TEST_P(WithoutBoardOf, eyes_in_one_place_have_too_little_parallax) {
  IdealRig rig = *draw_ideal(board.drawn.board, seed());
  const double apart = 0.005;
  const auto together = [&](auto& T) { T.translation() *= apart / T.translation().norm(); };
  together(rig.truth.rig.cameras[1].T_camera_rig);
  auto seen = observe(rig, board.commands, {.points = 25}, seed());
  seen.cameras = board.drawn.cameras;
  auto& drawn = seen.cameras.devices[1].T_device_rig.t;
  drawn *= apart / drawn.norm();
  const auto solution = calib::steer::solve_without_board(seen, board.drawn.drawing, {});
  ASSERT_FALSE(solution);
  EXPECT_EQ(solution.error().rcode, RCode::kTooLittleParallax) << solution.error().message();
}

}  // namespace
}  // namespace raysteer::support
