#include "firmware/capture/pattern_test.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::firmware::capture {
namespace {

using Frames = std::vector<std::optional<EyeSamples>>;

constexpr int kPanel = 256;
constexpr int kPlaces = 4000;

PatternSequence coded(bool complements, int steps) {
  return {.panel_width = kPanel,
          .panel_height = kPanel,
          .blocks = {{.kind = PatternKind::kWhite},
                     {.kind = PatternKind::kBlack},
                     {.kind = PatternKind::kGray, .bits = 5, .stripe_px = 8, .inverse = complements},
                     {.kind = PatternKind::kPhase, .steps = steps, .period_px = 16}}};
}

// A wall of uneven albedo under ambient light, noise of 1 % of white; each place sees one column, on one row in 100.
class Wall {
 public:
  explicit Wall(PatternSequence sequence, double gamma = 1)
      : sequence_(std::move(sequence)), gamma_(gamma), random_(support::seed()) {
    const std::vector<Pattern> patterns = sequence_.patterns();
    for (std::size_t k = 0; k < patterns.size(); ++k) {
      frames.emplace_back(see(static_cast<int>(k)));
    }
    references = make_references(*frames[0], *frames[1]);
  }

  /// What is seen when pattern `k` is shown, or in the first `torn` of the rows still pattern k - 1.
  EyeSamples see(int k, double torn = 0, double mixed = 0) { return {eye(k, torn, mixed), eye(k, torn, mixed)}; }

  Frames frames;
  References references;

 private:
  Samples eye(int k, double torn, double mixed) {
    const std::vector<Pattern> patterns = sequence_.patterns();
    std::normal_distribution<double> noise(0, 0.005);
    Samples samples(kPlaces);
    for (int i = 0; i < kPlaces; ++i) {
      const int x = static_cast<int>(i * 7919LL % kPanel);
      const double albedo = 0.3 + 0.3 * (i % 97) / 97.0;
      const Pattern& pattern = patterns[static_cast<std::size_t>(i % 100 < 100 * torn ? k - 1 : k)];
      double light = std::pow(pattern.value(x, 0), gamma_);
      if (mixed > 0) {
        light += mixed * (std::pow(patterns[static_cast<std::size_t>(k - 1)].value(x, 0), gamma_) - light);
      }
      samples[static_cast<std::size_t>(i)] = static_cast<float>(0.05 + albedo * light + noise(random_));
    }
    return samples;
  }

  PatternSequence sequence_;
  double gamma_;
  std::mt19937_64 random_;
};

std::vector<int> indices(const std::vector<WrongFrame>& wrong) {
  std::vector<int> all;
  std::ranges::transform(wrong, std::back_inserter(all), &WrongFrame::index);
  return all;
}

TEST(PatternTest, finds_nothing_wrong_with_good_frames) {
  for (const double gamma : {1.0, 2.2}) {
    for (const int steps : {3, 4, 8}) {
      const PatternSequence sequence = coded(true, steps);
      Wall wall(sequence, gamma);
      EXPECT_EQ(indices(find_wrong_frames(sequence, wall.references, wall.frames)), std::vector<int>{}) << steps;
      EXPECT_GT(*finest_contrast(sequence, wall.references, wall.frames), 0.9);
    }
  }
}

TEST(PatternTest, finds_each_frame_that_still_shows_the_one_before) {
  const PatternSequence sequence = coded(true, 8);
  Wall wall(sequence);
  for (int k = 2; k < sequence.frames(); ++k) {
    Frames frames = wall.frames;
    frames[static_cast<std::size_t>(k)] = wall.see(k - 1);
    const std::vector<int> wrong = indices(find_wrong_frames(sequence, wall.references, frames));
    EXPECT_TRUE(std::ranges::find(wrong, k) != wrong.end()) << k;
    EXPECT_LE(wrong.size(), 2U) << k;  // a complement cannot be told from its pattern
  }
}

TEST(PatternTest, finds_torn_pictures_and_late_ones) {
  const PatternSequence sequence = coded(true, 8);
  Wall wall(sequence);
  for (const int k : {4, 9, 14, 16, 18}) {
    Frames frames = wall.frames;
    frames[static_cast<std::size_t>(k)] = wall.see(k, 0.2);
    EXPECT_FALSE(find_wrong_frames(sequence, wall.references, frames).empty()) << k << " torn";
    frames[static_cast<std::size_t>(k)] = wall.see(k, 0, 1.0 / 3);
    EXPECT_FALSE(find_wrong_frames(sequence, wall.references, frames).empty()) << k << " a frame of three late";
  }
}

TEST(PatternTest, of_four_steps_cannot_say_which_is_wrong) {
  const PatternSequence sequence = coded(false, 4);
  Wall wall(sequence);
  wall.frames[8] = wall.see(7);
  EXPECT_EQ(indices(find_wrong_frames(sequence, wall.references, wall.frames)), (std::vector{7, 8, 9, 10}));
}

TEST(PatternTest, says_how_much_contrast_the_finest_stripes_keep) {
  const PatternSequence sequence = coded(true, 8);
  Wall wall(sequence);
  for (std::size_t k = 12; k < wall.frames.size(); ++k) {
    for (const std::size_t eye : {0U, 1U}) {
      Samples& samples = (*wall.frames[k])[eye];
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const EyeReference& reference = wall.references.eyes[eye];
        const float middle = 0.5F * (reference.white[i] + reference.black[i]);
        samples[i] = middle + 0.1F * (samples[i] - middle);
      }
    }
  }
  EXPECT_NEAR(*finest_contrast(sequence, wall.references, wall.frames), 0.1, 0.02);
}

TEST(References, tell_saturated_dark_and_unlit_apart) {
  const auto flat = [](float level) { return EyeSamples{Samples(kPlaces, level), Samples(kPlaces, level)}; };
  const auto code = [](const Status& status) { return status ? RCode::kNone : status.error().rcode; };
  EXPECT_EQ(code(judge_light(make_references(flat(0.8F), flat(0.1F)))), RCode::kNone);
  EXPECT_EQ(code(judge_light(make_references(flat(1.0F), flat(0.1F)))), RCode::kTooBright);
  EXPECT_EQ(code(judge_light(make_references(flat(1.0F), flat(1.0F)))), RCode::kTooBright);
  EXPECT_EQ(code(judge_light(make_references(flat(0.1F), flat(0.1F)))), RCode::kNothingLit);
  EXPECT_EQ(code(judge_light(make_references(flat(0.14F), flat(0.1F)))), RCode::kTooDark);
  EXPECT_EQ(judge_exposure(make_references(flat(0.8F), flat(0.1F))), ExposureVerdict::kGood);
  EXPECT_EQ(judge_exposure(make_references(flat(1.0F), flat(0.1F))), ExposureVerdict::kTooLong);
  EXPECT_EQ(judge_exposure(make_references(flat(0.2F), flat(0.1F))), ExposureVerdict::kTooShort);
}

TEST(References, see_what_moved_but_not_a_lamp_that_warms_up) {
  Wall wall(coded(true, 8));
  EyeSamples white = wall.see(0);
  EXPECT_TRUE(judge_stillness(wall.references, white));
  for (float& level : white[1]) {
    level *= 1.1F;
  }
  EXPECT_TRUE(judge_stillness(wall.references, white));
  for (std::size_t i = 0; i < kPlaces / 10; ++i) {
    white[1][i] = 0.2F;
  }
  const Status moved = judge_stillness(wall.references, white);
  ASSERT_FALSE(moved);
  EXPECT_EQ(moved.error().rcode, RCode::kSceneMoved);
}

}  // namespace
}  // namespace raysteer::firmware::capture
