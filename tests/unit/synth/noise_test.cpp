#include "calib/synth/noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace raysteer::calib::synth {
namespace {

TEST(Noise, normal_numbers_have_the_moments_and_tails_of_a_normal_distribution) {
  constexpr int kCount = 400000;
  Noise noise(7);
  double sums[5] = {};
  int beyond3 = 0;
  for (int i = 0; i < kCount; ++i) {
    const double z = noise.normal();
    for (int power = 1; power <= 4; ++power) {
      sums[power] += std::pow(z, power);
    }
    beyond3 += std::abs(z) > 3 ? 1 : 0;
  }
  // Five sigma of each moment's own scatter: sqrt(1, 2, 15, 96 / n); of a count: its root.
  const double root = std::sqrt(kCount);
  EXPECT_NEAR(sums[1] / kCount, 0, 5 / root);
  EXPECT_NEAR(sums[2] / kCount, 1, 5 * std::sqrt(2) / root);
  EXPECT_NEAR(sums[3] / kCount, 0, 5 * std::sqrt(15) / root);
  EXPECT_NEAR(sums[4] / kCount, 3, 5 * std::sqrt(96) / root);
  EXPECT_NEAR(beyond3, kCount * 0.0026998, 5 * std::sqrt(kCount * 0.0027));
}

TEST(Noise, streams_of_neighbouring_numbers_are_unrelated) {
  constexpr int kCount = 100000;
  Noise one(7, 3, 0);
  Noise next(7, 3, 1);
  double product = 0;
  for (int i = 0; i < kCount; ++i) {
    product += one.normal() * next.normal();
  }
  EXPECT_NEAR(product / kCount, 0, 5 / std::sqrt(kCount));
}

TEST(Noise, numbers_never_change_between_versions) {
  Noise noise(1);
  EXPECT_EQ(noise.bits(), 0x910a2dec89025cc1U);  // SplitMix64's published first output for seed 1
}

}  // namespace
}  // namespace raysteer::calib::synth
