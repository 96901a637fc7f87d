#include "hal/base/result.hpp"

#include <gtest/gtest.h>

#include <memory>

namespace raysteer {
namespace {

Result<int> half(int number) {
  if (number % 2 != 0) {
    return fail(RCode::kBadValue, "expected an even number, got " + std::to_string(number), number);
  }
  return number / 2;
}

Status is_multiple_of_four(int number) {
  const Result<int> once = half(number);
  RAYSTEER_TRY(once);
  RAYSTEER_TRY(half(*once));
  return ok();
}

TEST(Result, holds_the_value_of_a_success) {
  const Result<int> result = half(8);
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(*result, 4);
}

TEST(Result, holds_code_note_detail_and_place_of_a_failure) {
  const Result<int> result = half(7);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().rcode, RCode::kBadValue);
  EXPECT_EQ(result.error().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(result.error().detail, 7);
  EXPECT_EQ(result.error().message(), "a value is not usable: expected an even number, got 7");
  EXPECT_NE(std::string_view(result.error().file).find("result_test.cpp"), std::string_view::npos);
  EXPECT_GT(result.error().line, 0);
}

TEST(Result, moves_values_that_cannot_be_copied) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(3);
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 3);
}

TEST(Result, try_returns_the_first_error) {
  EXPECT_TRUE(is_multiple_of_four(8));
  EXPECT_EQ(is_multiple_of_four(6).error().detail, 3);
}

TEST(Result, context_goes_before_the_note) {
  EXPECT_EQ(with_context(half(5).error(), "key 'bits'").note, "key 'bits': expected an even number, got 5");
}

TEST(RaysteerCheck, aborts_when_the_condition_does_not_hold) {
  EXPECT_DEATH(RAYSTEER_CHECK(1 + 1 == 3), "1 \\+ 1 == 3 does not hold");
}

TEST(RCode, every_row_says_cause_and_remedy) {
  EXPECT_GT(all_rcodes().size(), 20U);
  for (const RCode rcode : all_rcodes()) {
    const Explanation& text = explain(rcode);
    EXPECT_FALSE(text.name.empty()) << to_string(rcode);
    EXPECT_FALSE(text.sentence.empty()) << to_string(rcode);
    EXPECT_FALSE(text.cause.empty()) << to_string(rcode);
    EXPECT_FALSE(text.remedy.empty()) << to_string(rcode);
  }
  EXPECT_EQ(to_string(RCode::kFrameMissing), "R0110");
}

}  // namespace
}  // namespace raysteer
