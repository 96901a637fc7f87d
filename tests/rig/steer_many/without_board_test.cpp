// What calibrating without any board promises, held against ideal rigs whose truth is known; tools/campaign
// self_calibration does so with 200 a board.
#include "tests/support/without_board.hpp"

#include <gtest/gtest.h>

#include <algorithm>
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

// Errors of the solved cameras are in a length that they measured, and so in the distance between the eyes. The mean of
// eight squares is above 3.3 once in a thousand; shares within 95 % are the campaign's.
TEST_P(WithoutBoardOf, lengths_are_as_sure_as_stated) {
  const auto found = many({.points = 25, .drawn_cameras = true, .known_ends = true}, 8);
  ASSERT_EQ(found.solved, 8);
  double of_scale = 0;
  double of_length = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    std::printf("  between the eyes %.3f %%, %.2f sigmas; on the floor %.3f %%, %.2f sigmas\n", 100 * found.scale[i],
                found.scale_normalised[i], 100 * found.length[i], found.length_normalised[i]);
    of_scale += found.scale_normalised[i] * found.scale_normalised[i] / 8;
    of_length += found.length_normalised[i] * found.length_normalised[i] / 8;
  }
  EXPECT_LT(of_scale, 3.3);
  EXPECT_LT(of_length, 3.3);
  EXPECT_LT(quantile(found.length, 0.5),
            2e-3);  // metres are those of the length, though the eyes' are off by per cents
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
        seen, board.drawn.drawing,
        calib::steer::KnownLength{.metres = metres, .sigma_m = sigma_m, .ends = {}, .ends_off_px = 0});
    return solution ? std::optional<RCode>() : solution.error().rcode;
  };
  EXPECT_EQ(code(0, 1e-3), RCode::kBadValue);
  EXPECT_EQ(code(-1, 1e-3), RCode::kBadValue);
  EXPECT_EQ(code(0.5, 0), RCode::kBadValue);
  EXPECT_EQ(code(std::nan(""), 1e-3), RCode::kNotFinite);
  EXPECT_EQ(code(0.5, std::nan("")), RCode::kNotFinite);
}

TEST_P(WithoutBoardOf, a_length_in_millimetres_is_named) {
  const IdealRig rig = *draw_ideal(board.drawn.board, seed());
  auto seen = observe(rig, board.commands, {.points = 25}, seed());
  seen.cameras = board.drawn.cameras;
  const double apart = rig.cameras.devices[1].T_device_rig.t.norm();
  for (const double factor : {1000.0, 1.5}) {
    const auto solution = calib::steer::solve_without_board(
        seen, board.drawn.drawing,
        calib::steer::KnownLength{.metres = factor * apart, .sigma_m = 1e-3, .ends = {}, .ends_off_px = 0});
    ASSERT_FALSE(solution);
    EXPECT_EQ(solution.error().rcode, RCode::kScaleWrong) << solution.error().message();
  }
}

TEST_P(WithoutBoardOf, looks_hardly_seen_are_left_out_by_name_and_pixels_that_are_none_refused) {
  const IdealRig rig = *draw_ideal(board.drawn.board, seed());
  auto seen = observe(rig, board.commands, {.points = 80}, seed());
  seen.cameras = board.drawn.cameras;
  const auto whole = calib::steer::solve_without_board(seen, board.drawn.drawing, {});
  ASSERT_TRUE(whole) << whole.error().message();
  ASSERT_LE(whole->left_out.size(), 1U);  // a look at the rim may be one that the drawn cameras hardly see
  // Most rays of the eyes now part: 40 of 80 are tried, and too few of those seen.
  auto& points = seen.looks[3].points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i % 10 > 2) {
      points[i].q[1] = points[i].q[0] + Eigen::Vector2d(800, 0);
    }
  }
  const auto solution = calib::steer::solve_without_board(seen, board.drawn.drawing, {});
  ASSERT_TRUE(solution) << solution.error().message();
  auto expected = whole->left_out;
  expected.push_back(seen.looks[3].name);
  auto left_out = solution->left_out;
  std::ranges::sort(expected);
  std::ranges::sort(left_out);
  EXPECT_EQ(left_out, expected);
  seen.looks[5].points[7].q[0].x() = std::nan("");
  const auto none = calib::steer::solve_without_board(seen, board.drawn.drawing, {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().rcode, RCode::kNotFinite) << none.error().message();
  for (auto& point : seen.looks[5].points) {
    point.q[0].x() = std::nan("");
  }
  const auto all = calib::steer::solve_without_board(seen, board.drawn.drawing, {});
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().rcode, RCode::kNotFinite) << all.error().message();
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
