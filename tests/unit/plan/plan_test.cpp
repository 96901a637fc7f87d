#include "proto/plan/plan.hpp"

#include <gtest/gtest.h>

#include <string>

namespace raysteer::proto::plan {
namespace {

const std::string kWhole = R"(format = 1
name = "demo"
exposure_us = 16666.7
[[look]]
name = "pose_1"
mirror_mrad = [0, -25]
prepare = "target pose 1"
[[look]]
name = "step"
mirror_mrad = [10, 0]
[[target]]
kind = "chessboard"
columns = 9
rows = 7
square_m = 0.03
looks = ["pose_1"]
)";

Error error_of(const std::string& from, const std::string& to) {
  std::string text = kWhole;
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  const Result<Plan> plan = read_plan(text.replace(at, from.size(), to), "plan.toml");
  EXPECT_FALSE(plan) << to;
  return plan ? Error{} : plan.error();
}

TEST(Plan, comes_in_radians_with_its_looks_and_targets) {
  const Result<Plan> plan = read_plan(kWhole, "plan.toml");
  ASSERT_TRUE(plan) << plan.error().message();
  ASSERT_EQ(plan->looks.size(), 2U);
  EXPECT_EQ(plan->looks[0].mirror_rad, (std::array{0.0, -0.025}));
  EXPECT_EQ(plan->looks[0].prepare, "target pose 1");
  EXPECT_TRUE(plan->blocks.empty());
  ASSERT_EQ(plan->targets.size(), 1U);
  EXPECT_EQ(plan->targets[0].spec.columns, 9);
  EXPECT_DOUBLE_EQ(*plan->exposure_us, 16666.7);
}

TEST(Plan, refuses_each_mistake_by_name) {
  EXPECT_EQ(error_of("mirror_mrad", "mirror_deg").rcode, RCode::kUnknownKey);
  EXPECT_NE(error_of("mirror_mrad", "mirror_rad").note.find("'mirror_mrad'"), std::string::npos);
  EXPECT_EQ(error_of("[0, -25]", "[0, -25, 1]").rcode, RCode::kBadValue);
  EXPECT_EQ(error_of("[0, -25]", "[0, -25000]").rcode, RCode::kBadValue);
  EXPECT_EQ(error_of("[0, -25]", "[0, nan]").rcode, RCode::kBadValue);
  EXPECT_EQ(error_of("name = \"step\"", "name = \"pose_1\"").rcode, RCode::kBadValue);
  EXPECT_EQ(error_of("name = \"step\"", "name = \"../step\"").rcode, RCode::kBadValue);
  EXPECT_EQ(error_of("looks = [\"pose_1\"]", "looks = [\"pose_9\"]").rcode, RCode::kBadValue);
  EXPECT_EQ(read_plan("format = 1\nname = \"empty\"\n", "plan.toml").error().rcode, RCode::kMissingKey);
}

TEST(PatternSet, has_as_many_patterns_as_the_design_says) {
  EXPECT_EQ(pattern_set("default", 1920, 1200)->frames(), 51);
  EXPECT_EQ(pattern_set("fast", 1920, 1200)->frames(), 27);
  EXPECT_EQ(pattern_set("best", 1920, 1200)->frames(), 67);
  EXPECT_EQ(pattern_set("gray", 1920, 1200)->frames(), 47);
}

TEST(PatternSet, begins_with_white_and_black_on_any_panel) {
  for (const char* name : {"default", "fast", "best", "gray"}) {
    for (const int width : {16, 240, 912, 4096}) {
      const Result<PatternSequence> sequence = pattern_set(name, width, width / 2);
      ASSERT_TRUE(sequence) << name << " " << width << ": " << sequence.error().message();
      EXPECT_EQ(sequence->blocks[0].kind, PatternKind::kWhite);
      EXPECT_EQ(sequence->blocks[1].kind, PatternKind::kBlack);
    }
  }
}

TEST(PatternSet, lists_the_names_for_one_it_does_not_know) {
  const Result<PatternSequence> sequence = pattern_set("grey", 1920, 1200);
  ASSERT_FALSE(sequence);
  EXPECT_EQ(sequence.error().rcode, RCode::kBadValue);
  EXPECT_NE(sequence.error().note.find("did you mean 'gray'"), std::string::npos);
}

}  // namespace
}  // namespace raysteer::proto::plan
