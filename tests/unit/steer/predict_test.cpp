// What a solved rig says of looks it never saw, against the truth.
#include "calib/steer/predict.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/steer/evaluate.hpp"
#include "calib/steer/eye_points.hpp"
#include "calib/steer/refine.hpp"
#include "tests/support/ideal_rig.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/steer/boards.hpp"

namespace raysteer::calib::steer {
namespace {

class Predict : public testing::TestWithParam<const char*> {
 protected:
  proto::board::Board board = support::board_named(GetParam());
  std::uint64_t seed = support::seed();
  support::IdealRig rig = *support::draw_ideal(board, seed);
  Solution solution =
      *solve(support::observe(rig, support::command_grid(rig.projector, 4, 4, 0.8), {.points = 60}, seed),
             support::drawing_of(board));
  std::vector<Eigen::Vector2d> unseen = support::command_grid(rig.projector, 4, 3, 0.6);

  /// Without noise of pixels: what is left is the calibration's error, and the mirror's.
  Observations exact(double repeatability_rad = 20e-6, int points = 25) const {
    return support::observe(rig, unseen, {.noise_px = 0, .repeatability_rad = repeatability_rad, .points = points},
                            seed, nullptr, 1);
  }
  /// Dots as both eyes see them.
  std::vector<Dot> dots(const Look& look) const {
    const Eigen::MatrixXd held(solution.camera_parameters(), 0);
    const Eyes eyes(solution.cameras, held);
    std::vector<Dot> dots;
    for (const LitPoint& point : look.points) {
      const auto seen = eyes.see(point);
      dots.push_back({point.x, seen->p, seen->covariance});
    }
    return dots;
  }
};

// Errors over their stated variance: 1 on average; one rig's looks share its calibration, so the bound is wide. The
// campaign of ideal rigs holds the statistics.
TEST_P(Predict, unseen_looks_within_their_stated_uncertainty) {
  double sum = 0;
  int count = 0;
  for (const Look& look : exact().looks) {
    for (const Dot& dot : dots(look)) {
      const auto prediction = predict(solution, look.command_rad, dot.p);
      ASSERT_TRUE(prediction);
      const Eigen::Vector2d error = prediction->x - dot.x;
      sum += error.dot(prediction->covariance.inverse() * error);
      ++count;
      ASSERT_LT(error.norm(), 5);
    }
  }
  const double normalised = sum / (2 * count);
  std::printf("%s: normalised %.2f\n", GetParam(), normalised);
  EXPECT_GT(normalised, 0.2);
  EXPECT_LT(normalised, 3);
}

TEST_P(Predict, a_pixel_lands_where_it_is_predicted_from) {
  const Surface floor{{0, 0, support::kFloorDepth}, {0, 0, -1}};
  const Eigen::Vector2d x(700, 500);
  const auto landing = land(solution, unseen[4], x, floor);
  ASSERT_TRUE(landing);
  EXPECT_NEAR(landing->p.z(), support::kFloorDepth, 1e-9);
  const auto back = predict(solution, unseen[4], landing->p, PointFrom::kCameras, floor);
  ASSERT_TRUE(back);
  EXPECT_LT((back->x - x).norm(), 1e-6);
  // The plane's covariance is the panel's in other units: 3-D along the floor, nothing across it.
  EXPECT_NEAR(landing->covariance.trace(), 1e-6 * back->covariance_mm2()->trace(), 1e-12);
  EXPECT_NEAR(landing->covariance(2, 2), 0, 1e-15);
  // About 0.95 mm a pixel: the area a pixel covers, within what obliquity does.
  EXPECT_GT(std::abs(back->mm_per_px->determinant()), 0.5);
  EXPECT_LT(std::abs(back->mm_per_px->determinant()), 3);
  EXPECT_FALSE(land(solution, unseen[4], x, {{0, 0, -2}, {0, 0, 1}}));
}

TEST_P(Predict, held_out_looks_say_how_good_the_rig_is) {
  const auto clean = evaluate(solution, exact(20e-6, 60).looks);
  ASSERT_TRUE(clean);
  const auto noisy = evaluate(
      solution, support::observe(rig, unseen, {.repeatability_rad = 20e-6, .points = 200}, seed, nullptr, 1).looks);
  ASSERT_TRUE(noisy) << noisy.error().message();
  std::printf("%s: held out %.3f / %.3f px, exact %.3f / %.3f px, %.3f / %.3f mm, normalised %.2f\n", GetParam(),
              noisy->median_px, noisy->p95_px, clean->median_px, clean->p95_px, noisy->median_mm, noisy->p95_mm,
              noisy->normalised);
  EXPECT_LT(noisy->p95_px, 1);
  EXPECT_NEAR(noisy->p95_px, clean->p95_px, 0.25);
  EXPECT_GT(noisy->raw_p95_px, noisy->p95_px);
  EXPECT_EQ(noisy->looks.size(), unseen.size());
  EXPECT_EQ(evaluate(solution, {}).error().rcode, RCode::kTooFewLooks);
}

// 200 urad are 1.5 px; 20 dots bring the look back to what the calibration alone leaves.
TEST_P(Predict, a_refined_look_forgets_the_mirrors_scatter) {
  const Observations away = exact(200e-6, 40);
  const Observations seen =
      support::observe(rig, unseen, {.noise_px = 0.2, .repeatability_rad = 200e-6, .points = 40}, seed, nullptr, 1);
  double before = 0;
  double after = 0;
  double normalised = 0;
  int count = 0;
  for (std::size_t k = 0; k < unseen.size(); ++k) {
    // The same stream draws the same latents: exact points of the same mirror position.
    std::vector<Dot> noisy = dots(seen.looks[k]);
    noisy.resize(20);
    const auto refined = refine_look(solution, unseen[k], noisy);
    ASSERT_TRUE(refined) << refined.error().message();
    EXPECT_LT(refined->whitened_rms, 1.6);
    for (const Dot& dot : dots(away.looks[k])) {
      const auto open = predict(solution, unseen[k], dot.p);
      const auto closed = predict(solution, unseen[k], dot.p, PointFrom::kCameras, std::nullopt, refined->state);
      before += (open->x - dot.x).squaredNorm();
      after += (closed->x - dot.x).squaredNorm();
      const Eigen::Vector2d error = closed->x - dot.x;
      normalised += error.dot(closed->covariance.inverse() * error) / 2;
      ++count;
    }
  }
  std::printf("%s: open %.3f px, closed %.3f px rms, normalised %.2f\n", GetParam(), std::sqrt(before / count),
              std::sqrt(after / count), normalised / count);
  EXPECT_GT(std::sqrt(before / count), 0.8);
  EXPECT_LT(std::sqrt(after / count), 0.35);
  EXPECT_GT(normalised / count, 0.2);
  EXPECT_LT(normalised / count, 3);
}

TEST_P(Predict, dots_of_another_look_are_refused) {
  const Observations seen = exact();
  EXPECT_EQ(refine_look(solution, unseen[0], dots(seen.looks[7])).error().rcode, RCode::kLookNotSolved);
  EXPECT_EQ(refine_look(solution, unseen[0], {}).error().rcode, RCode::kTooFewCorrespondences);
  std::vector<Dot> bad = dots(seen.looks[0]);
  bad[1].p.x() = std::nan("");
  EXPECT_EQ(refine_look(solution, unseen[0], bad).error().rcode, RCode::kNotFinite);
}

TEST_P(Predict, a_wrong_dot_does_not_move_the_look) {
  std::vector<Dot> good = dots(exact().looks[3]);
  const auto before = refine_look(solution, unseen[3], good);
  good[2].x += Eigen::Vector2d(80, -30);
  const auto after = refine_look(solution, unseen[3], good);
  ASSERT_TRUE(before && after);
  EXPECT_LT((after->state.latent_rad - before->state.latent_rad).norm(), 5e-6);
  EXPECT_EQ(after->used + 1, before->used);
}

TEST_P(Predict, drift_is_found_from_dots_at_several_looks) {
  support::IdealRig drifted = rig;
  const Eigen::Vector2d offset(300e-6, -200e-6);
  const Eigen::Vector2d gain(5e-4, -3e-4);
  for (int axis = 0; axis < 2; ++axis) {
    // angle' = angle (1 + gain); an offset is what a command of offset would have done.
    model::CommandCurve& c = drifted.projector.curves[static_cast<std::size_t>(axis)];
    c.quadratic *= 1 + gain[axis];
    c.cubic *= 1 + gain[axis];
    c.cross_talk *= 1 + gain[axis];
    c.gain = (1 + c.gain) * (1 + gain[axis]) - 1;
  }
  auto& mirror = drifted.truth.rig.mirror;
  mirror.parts[0].normal =
      Eigen::AngleAxisd(mirror.head ? offset.y() : offset.x(), mirror.parts[0].axis) * mirror.parts[0].normal;
  Eigen::Vector2d expected = offset;
  if (mirror.head) {
    expected.x() = 0;  // the outer axis keeps its zero here
  } else {
    mirror.parts[1].normal = Eigen::AngleAxisd(offset.y(), mirror.parts[1].axis) * mirror.parts[1].normal;
  }
  const Observations seen =
      support::observe(drifted, unseen, {.noise_px = 0.2, .repeatability_rad = 20e-6, .points = 20}, seed, nullptr, 1);
  std::vector<DottedLook> looks;
  for (const Look& look : seen.looks) {
    looks.push_back({look.command_rad, dots(look)});
  }
  const auto drift = refine_drift(solution, looks);
  ASSERT_TRUE(drift) << drift.error().message();
  // 12 looks of 20 urad scatter, beside what the calibration itself is off by: 6 of their sigmas.
  EXPECT_LT((drift->offset_rad - expected).norm(), 60e-6);
  EXPECT_LT((drift->gain - gain).norm(), 4e-4);
  EXPECT_GT(drift->covariance.diagonal().minCoeff(), 0);
  const LookState state = drift->at(solution, unseen[0]);
  EXPECT_LT((state.latent_rad - expected - gain.cwiseProduct(unseen[0])).norm(), 120e-6);
}

INSTANTIATE_TEST_SUITE_P(Boards, Predict, testing::Values("mock-galvo", "mock-head"));

}  // namespace
}  // namespace raysteer::calib::steer
