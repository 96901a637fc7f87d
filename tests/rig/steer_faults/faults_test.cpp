// What a rig must not be solved from, and what it says instead.
#include <gtest/gtest.h>

#include <limits>

#include "calib/steer/evaluate.hpp"
#include "calib/steer/solve.hpp"
#include "tests/support/ideal_rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::calib::steer {
namespace {

class Faults : public testing::TestWithParam<const char*> {
 protected:
  proto::board::Board board = support::board_named(GetParam());
  Drawing drawing = support::drawing_of(board);
  std::uint64_t seed = support::seed();
  support::IdealRig rig = *support::draw_ideal(board, seed);
  std::vector<Eigen::Vector2d> commands = support::command_grid(rig.projector, 4, 4, 0.8);
  Observations observations = support::observe(rig, commands, {.points = 25}, seed);

  Error refusal() const {
    auto solution = solve(observations, drawing);
    return solution ? Error{} : std::move(solution).error();
  }
  /// The same looks with a bumped rig from look `from` on.
  void bump(std::size_t from, double rad, double metres, bool camera) {
    support::IdealRig bumped = rig;
    Eigen::Isometry3d& T =
        camera ? bumped.truth.rig.cameras[1].T_camera_rig : bumped.truth.rig.projector.T_projector_rig;
    T.prerotate(Eigen::AngleAxisd(rad, Eigen::Vector3d(1, 2, 2).normalized()));
    T.pretranslate(metres * Eigen::Vector3d(2, -1, 2).normalized());
    const Observations after = support::observe(bumped, commands, {.points = 25}, seed);
    for (std::size_t k = from; k < observations.looks.size(); ++k) {
      observations.looks[k] = after.looks[k];
    }
  }
};

TEST_P(Faults, few_looks_and_few_levels_are_refused) {
  observations.looks.resize(5);
  EXPECT_EQ(refusal().rcode, RCode::kTooFewLooks);
  observations = support::observe(rig, support::command_grid(rig.projector, 3, 3, 0.8), {.points = 20}, seed);
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kTooFewLooks);
  EXPECT_NE(error.note.find("3 distinct levels of axis 1"), std::string::npos) << error.note;
}

TEST_P(Faults, numbers_that_are_none_are_refused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Observations good = observations;
  observations.looks[4].command_rad.x() = kNan;
  EXPECT_EQ(refusal().rcode, RCode::kNotFinite);
  EXPECT_NE(refusal().note.find("look-5"), std::string::npos);
  observations = good;
  observations.looks[2].points[7].x.y() = kNan;
  EXPECT_EQ(refusal().rcode, RCode::kNotFinite);
  observations = good;
  observations.looks[2].points[7].cov_q[1](0, 0) = -1;
  EXPECT_EQ(refusal().rcode, RCode::kBadValue);
  observations = good;
  observations.looks[3].feedback_rad = Eigen::Vector2d(0, kNan);
  EXPECT_EQ(refusal().rcode, RCode::kNotFinite);
  observations = good;
  observations.cameras.devices.pop_back();
  EXPECT_EQ(refusal().rcode, RCode::kCameraCount);
  observations = good;
  observations.cameras.covariance.resize(3, 3);
  EXPECT_EQ(refusal().rcode, RCode::kBadValue);
  observations = good;
  drawing.tolerance.gain = 0;
  EXPECT_EQ(refusal().rcode, RCode::kBadValue);
}

TEST_P(Faults, missing_feedback_is_fine_and_dark_looks_are_left_out) {
  for (Look& look : observations.looks) {
    look.feedback_rad.reset();
  }
  observations.looks[6].points.resize(3);
  const auto solution = solve(observations, drawing);
  ASSERT_TRUE(solution) << solution.error().message();
  EXPECT_EQ(solution->left_out, std::vector<std::string>{"look-7"});
  EXPECT_EQ(solution->looks.size(), 15U);
}

TEST_P(Faults, looks_out_of_order_contradict_the_feedback) {
  std::swap(observations.looks[3].command_rad, observations.looks[9].command_rad);
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kFeedbackDisagrees);
  EXPECT_NE(error.note.find("look-4"), std::string::npos) << error.note;
  EXPECT_NE(error.note.find("look-10"), std::string::npos) << error.note;
}

TEST_P(Faults, a_look_with_another_ones_frames_is_named) {
  observations.looks[5].points = support::observe(rig, commands, {.points = 25}, seed, nullptr, 7).looks[10].points;
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kLookForeign);
  EXPECT_NE(error.note.find("look 'look-6' (its frames fit the command of look 'look-11')"), std::string::npos)
      << error.note;
}

TEST_P(Faults, two_exchanged_looks_are_named_without_feedback) {
  for (Look& look : observations.looks) {
    look.feedback_rad.reset();
  }
  std::swap(observations.looks[3].points, observations.looks[9].points);
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kLookForeign);
  EXPECT_NE(error.note.find("look-4"), std::string::npos) << error.note;
  EXPECT_NE(error.note.find("look-10"), std::string::npos) << error.note;
}

TEST_P(Faults, a_look_whose_mirror_slipped_is_named) {
  support::IdealRig slipped = rig;
  slipped.truth.rig.mirror.parts[0].normal =
      Eigen::AngleAxisd(1e-3, rig.truth.rig.mirror.parts[0].axis) * rig.truth.rig.mirror.parts[0].normal;
  observations.looks[7] = support::observe(slipped, commands, {.points = 25}, seed).looks[7];
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kLookForeign);
  EXPECT_NE(error.note.find("look-8"), std::string::npos) << error.note;
}

TEST_P(Faults, a_bumped_projector_is_named_and_when) {
  bump(8, 3e-3, 3e-3, false);
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kRigMoved);
  EXPECT_NE(error.note.find("between looks 'look-8' and 'look-9': projector"), std::string::npos) << error.note;
}

TEST_P(Faults, a_bumped_camera_is_named_and_when) {
  bump(6, 2e-3, 1e-3, true);
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kRigMoved);
  EXPECT_NE(error.note.find("between looks 'look-6' and 'look-7': the right camera"), std::string::npos) << error.note;
}

TEST_P(Faults, a_reversed_axis_is_named) {
  for (const int axis : {0, 1}) {
    const Observations good = observations;
    for (Look& look : observations.looks) {
      look.command_rad[axis] *= -1;
      (*look.feedback_rad)[axis] *= -1;
    }
    const Error error = refusal();
    EXPECT_EQ(error.rcode, RCode::kAxisReversed);
    EXPECT_NE(error.note.find("axis " + std::to_string(axis + 1) + " is reversed"), std::string::npos) << error.note;
    observations = good;
  }
}

TEST_P(Faults, exchanged_axes_are_named) {
  for (Look& look : observations.looks) {
    const double ratio = drawing.projector.curves[0].half_range / drawing.projector.curves[1].half_range;
    look.command_rad = {look.command_rad.y() * ratio, look.command_rad.x() / ratio};
    look.feedback_rad.reset();
  }
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kAxisReversed);
  EXPECT_NE(error.note.find("axes are exchanged"), std::string::npos) << error.note;
}

TEST_P(Faults, a_flipped_picture_is_named) {
  for (Look& look : observations.looks) {
    for (LitPoint& point : look.points) {
      point.x.x() = board.projector.width - 1 - point.x.x();
    }
  }
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kPictureMirrored);
  EXPECT_NE(error.note.find("left to right"), std::string::npos) << error.note;
}

TEST_P(Faults, shuffled_looks_are_not_solved) {
  for (Look& look : observations.looks) {
    look.feedback_rad.reset();
  }
  for (std::size_t k = 0; k < observations.looks.size(); ++k) {
    std::swap(observations.looks[k].points, observations.looks[(7 * k + 3) % 16].points);
  }
  EXPECT_EQ(refusal().rcode, RCode::kRigNotSolved);
}

TEST_P(Faults, a_drawing_off_by_20_mm_still_converges_or_is_said) {
  drawing.projector.parts[0].point += 0.02 * Eigen::Vector3d(1, 1, 1).normalized();
  const auto solution = solve(observations, drawing);
  if (solution) {
    const auto unseen =
        support::observe(rig, support::command_grid(rig.projector, 3, 3, 0.5), {.points = 25}, seed, nullptr, 1);
    const auto held_out = evaluate(*solution, unseen.looks);
    ASSERT_TRUE(held_out) << held_out.error().message();
    EXPECT_LT(held_out->p95_px, 1);
  } else {
    EXPECT_EQ(solution.error().rcode, RCode::kDrawingsDisagree) << solution.error().message();
  }
}

// The rig is solved all the same, and the drawing is blamed, not believed.
TEST_P(Faults, a_drawing_that_claims_more_than_it_keeps_is_said_to_be_wrong) {
  drawing.projector.lens.fx = 1.04 * rig.projector.lens.fx;
  drawing.projector.lens.fy = 1.04 * rig.projector.lens.fy;
  drawing.tolerance.focal = 0.002;
  const Error error = refusal();
  EXPECT_EQ(error.rcode, RCode::kDrawingsDisagree) << error.message();
  EXPECT_NE(error.note.find("tolerances away from the board file"), std::string::npos) << error.note;
}

INSTANTIATE_TEST_SUITE_P(Boards, Faults, testing::Values("mock-galvo", "mock-head"));

}  // namespace
}  // namespace raysteer::calib::steer
