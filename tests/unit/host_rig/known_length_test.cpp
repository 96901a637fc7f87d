// Lengths as people write them on the command line: what is none is refused, never half read.
#include "host/rig/known_length.hpp"

#include <gtest/gtest.h>

namespace raysteer::host::rig {
namespace {

TEST(KnownLength, is_read_as_two_datums_and_metres) {
  const auto length = read_length("3-115=2.514");
  ASSERT_TRUE(length);
  EXPECT_EQ(length->metres, 2.514);
  ASSERT_TRUE(length->datums);
  EXPECT_EQ((*length->datums)[0], 3U);
  EXPECT_EQ((*length->datums)[1], 115U);
}

TEST(KnownLength, of_the_baseline_is_metres_alone) {
  const auto baseline = read_baseline("0.512");
  ASSERT_TRUE(baseline);
  EXPECT_EQ(baseline->metres, 0.512);
  EXPECT_FALSE(baseline->datums);
}

TEST(KnownLength, that_is_none_is_refused) {
  for (const char* text :
       {"",       "3-7",    "3=2.5",  "=2.5",    "-7=2",    "3-=2",      "3-3=1",           "a-7=2",
        "3-7=",   "3-7=0",  "3-7=-2", "3-7=nan", "3-7=inf", "3-7=1e999", "3-7=0x1p3",       "3-7= 2",
        " 3-7=2", "3- 7=2", "3-7=2 ", "3-7=2m",  "3-7=2,5", "-3-7=2",    "99999999999-7=2", "3-7=2=2"}) {
    const auto length = read_length(text);
    ASSERT_FALSE(length) << text;
    EXPECT_EQ(length.error().rcode, RCode::kUsage);
  }
  for (const char* text : {"", "0", "-0.5", "nan", "inf", "0x1p3", " 0.5", "0.5 ", "0.5m", "0,5", "half"}) {
    const auto baseline = read_baseline(text);
    ASSERT_FALSE(baseline) << text;
    EXPECT_EQ(baseline.error().rcode, RCode::kUsage);
  }
}

}  // namespace
}  // namespace raysteer::host::rig
