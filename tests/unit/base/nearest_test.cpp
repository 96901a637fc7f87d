#include "hal/base/nearest.hpp"

#include <gtest/gtest.h>

#include <array>

namespace raysteer {
namespace {

TEST(EditDistance, counts_inserts_deletes_replacements_and_swaps) {
  EXPECT_EQ(edit_distance("", "abc"), 3);
  EXPECT_EQ(edit_distance("check", "check"), 0);
  EXPECT_EQ(edit_distance("chekc", "check"), 1);
  EXPECT_EQ(edit_distance("chck", "check"), 1);
  EXPECT_EQ(edit_distance("cheque", "check"), 3);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3);
}

TEST(Nearest, finds_the_word_that_was_meant) {
  constexpr std::array<std::string_view, 4> known{"check", "info", "calibrate", "scan"};
  EXPECT_EQ(nearest("chekc", known), "check");
  EXPECT_EQ(nearest("calibarte", known), "calibrate");
  EXPECT_EQ(did_you_mean("scna", known), "; did you mean 'scan'?");
}

TEST(Nearest, suggests_nothing_when_nothing_is_near) {
  constexpr std::array<std::string_view, 4> known{"check", "info", "calibrate", "scan"};
  EXPECT_EQ(nearest("elephant", known), "");
  const std::vector<std::string_view> keys{"name", "mirror_mrad"};
  EXPECT_EQ(nearest("mirror_deg", keys), "mirror_mrad");  // another unit
  EXPECT_EQ(nearest("x", known), "");
  EXPECT_EQ(did_you_mean("elephant", known), "");
}

}  // namespace
}  // namespace raysteer
