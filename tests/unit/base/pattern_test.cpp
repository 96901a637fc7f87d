#include "hal/base/pattern.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace raysteer {
namespace {

PatternSequence gray(int bits, bool inverse) {
  return {.panel_width = 1 << bits,
          .panel_height = 4,
          .blocks = {{.kind = PatternKind::kGray, .axis = Axis::kX, .bits = bits, .inverse = inverse}}};
}

TEST(Pattern, neighbouring_columns_differ_in_one_gray_bit_only) {
  const std::vector<Pattern> patterns = gray(6, false).patterns();
  ASSERT_EQ(patterns.size(), 6U);
  for (int x = 0; x + 1 < 64; ++x) {
    int changes = 0;
    for (const Pattern& pattern : patterns) {
      changes += pattern.value(x, 0) != pattern.value(x + 1, 0) ? 1 : 0;
    }
    EXPECT_EQ(changes, 1) << "column " << x;
  }
}

TEST(Pattern, bits_come_most_significant_first_unless_asked) {
  PatternSequence sequence = gray(5, false);
  EXPECT_EQ(sequence.patterns().front().bit, 4);
  sequence.blocks[0].lsb_first = true;
  EXPECT_EQ(sequence.patterns().front().bit, 0);
}

TEST(Pattern, inverse_is_the_complement_and_follows_or_leads) {
  PatternSequence sequence = gray(5, true);
  ASSERT_EQ(sequence.frames(), 10);
  for (const bool leads : {false, true}) {
    sequence.blocks[0].inverse_first = leads;
    const std::vector<Pattern> patterns = sequence.patterns();
    EXPECT_EQ(patterns[0].inverted, leads);
    for (int x = 0; x < 32; ++x) {
      EXPECT_EQ(patterns[2].value(x, 0) + patterns[3].value(x, 0), 1);
    }
  }
}

TEST(Pattern, phase_steps_shift_by_a_period_over_steps) {
  const PatternBlock block{.kind = PatternKind::kPhase, .axis = Axis::kY, .steps = 8, .period_px = 16};
  const Pattern first{.block = block, .step = 0};
  const Pattern third{.block = block, .step = 2};
  for (int y = 0; y < 16; ++y) {
    EXPECT_NEAR(first.value(0, y), 0.5 + 0.5 * std::cos(2 * std::numbers::pi * y / 16.0), 1e-12);
    EXPECT_NEAR(third.value(0, y + 4), first.value(0, y), 1e-12);
  }
}

TEST(PatternSequence, refuses_what_cannot_be_told_apart) {
  PatternSequence sequence = gray(5, false);
  EXPECT_TRUE(check(sequence));
  sequence.panel_width = 33;
  EXPECT_EQ(check(sequence).error().rcode, RCode::kBadSequence);
  sequence.blocks[0] = {.kind = PatternKind::kPhase, .steps = 2, .period_px = 16};
  EXPECT_EQ(check(sequence).error().rcode, RCode::kBadSequence);
}

}  // namespace
}  // namespace raysteer
