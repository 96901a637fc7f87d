#include "firmware/capture/flicker.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "tests/support/seed.hpp"

namespace raysteer::firmware::capture {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr nanoseconds kShort{2'000'000};
constexpr nanoseconds kFrame{16'666'667};

// Exposures of 2 ms at the phases that a capture uses, of light that flickers by `modulation`.
std::vector<AmbientSample> burst(double hz, double modulation, double noise, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const double turn = 2 * std::numbers::pi * hz;
  const double phase = std::uniform_real_distribution<double>(0, 6.28)(random);
  std::vector<AmbientSample> samples;
  for (const int rests : {0, 1, 3, 4, 5, 7}) {
    const double at = 0.05 * rests + 0.0117 * static_cast<double>(samples.size());
    const double half = 1e-3;
    const double light = 1 + modulation *
                                 (std::sin(turn * (at + half) + phase) - std::sin(turn * (at - half) + phase)) /
                                 (2 * half * turn);
    samples.push_back({nanoseconds(std::llround(1e9 * at)), 0.1 * light + noise * normal(random)});
  }
  return samples;
}

TEST(Flicker, of_the_mains_is_measured_and_its_frequency_told) {
  std::mt19937_64 random(support::seed());
  for (const double hz : {100.0, 120.0}) {
    for (int k = 0; k < 20; ++k) {
      const Flicker flicker = find_flicker(burst(hz, 0.3, 1e-4, random), kShort);
      EXPECT_TRUE(flicker.noticed);
      EXPECT_EQ(flicker.hz, hz);
      EXPECT_NEAR(flicker.modulation, 0.3, 0.015);
    }
  }
}

TEST(Flicker, is_not_seen_in_steady_light) {
  std::mt19937_64 random(support::seed());
  for (int k = 0; k < 200; ++k) {
    EXPECT_FALSE(find_flicker(burst(100, 0, 1e-4, random), kShort).noticed);
  }
}

TEST(Flicker, of_five_samples_is_not_claimed) {
  std::mt19937_64 random(support::seed());
  std::vector<AmbientSample> samples = burst(100, 0.3, 0, random);
  samples.pop_back();
  EXPECT_FALSE(find_flicker(samples, kShort).noticed);
}

TEST(Exposure, is_whole_half_periods_of_the_mains_and_whole_frames) {
  const Flicker hundred{.hz = 100, .modulation = 0.3, .sigma = 0.001, .noticed = true};
  const ExposureLimits limits{.least = nanoseconds(20'000), .most = milliseconds(1'000), .frame = kFrame};
  EXPECT_EQ(choose_exposure(hundred, limits, milliseconds(60))->count(), 3 * kFrame.count());
  EXPECT_LT(flicker_left(hundred, 3 * kFrame), 1e-6);
  const Flicker hundred_twenty{.hz = 120, .modulation = 0.3, .sigma = 0.001, .noticed = true};
  EXPECT_EQ(choose_exposure(hundred_twenty, limits, milliseconds(40))->count(), 2 * kFrame.count());
}

TEST(Exposure, of_a_trigger_master_need_not_be_whole_frames) {
  const Flicker hundred{.hz = 100, .modulation = 0.3, .sigma = 0.001, .noticed = true};
  const ExposureLimits limits{.least = nanoseconds(20'000), .most = milliseconds(33), .frame = {}};
  EXPECT_EQ(*choose_exposure(hundred, limits, milliseconds(50)), milliseconds(30));
  EXPECT_EQ(*choose_exposure(Flicker{}, limits, milliseconds(50)), milliseconds(33));
}

TEST(Exposure, of_less_than_a_frame_is_refused_for_a_display) {
  const ExposureLimits limits{.least = nanoseconds(20'000), .most = milliseconds(10), .frame = kFrame};
  EXPECT_FALSE(choose_exposure(Flicker{}, limits, milliseconds(50)));
}

}  // namespace
}  // namespace raysteer::firmware::capture
