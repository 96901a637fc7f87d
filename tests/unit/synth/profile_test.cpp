#include "calib/synth/profile.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace raysteer::calib::synth {
namespace {

/// A blurred edge that rises at `edge`, averaged over the parallelogram's shadow by brute force.
double edge_mean(double centre, double a, double b, double edge, double sigma) {
  constexpr int kSteps = 200;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = centre + a * ((i + 0.5) / kSteps - 0.5) + b * ((j + 0.5) / kSteps - 0.5);
      sum += 0.5 * std::erfc(-(x - edge) / (sigma * std::numbers::sqrt2));
    }
  }
  return sum / (kSteps * kSteps);
}

TEST(Profile, means_over_any_footprint_agree_with_the_integral_of_a_blurred_edge) {
  std::vector<double> pixels(64, 0.0);
  for (std::size_t i = 32; i < pixels.size(); ++i) {
    pixels[i] = 1;
  }
  for (const double sigma : {0.3, 0.6, 1.5}) {
    const Profile profile(pixels, sigma);
    for (const auto& [a, b] : {std::pair(0.0, 0.0), {0.7, 0.0}, {1.3, 0.2}, {-0.4, 2.5}, {1.0, 1.0}}) {
      for (const double centre : {29.9, 31.2, 31.5, 31.77, 33.0}) {
        // The polyline departs from the blurred edge by at most step^2 / 8 * curvature.
        const double polyline = 0.242 / (sigma * sigma) / (8 * 256);
        EXPECT_NEAR(profile.mean(centre, a, b), edge_mean(centre, a, b, 31.5, sigma), polyline + 1e-5)
            << "sigma " << sigma << " centre " << centre << " a " << a << " b " << b;
      }
    }
  }
}

TEST(Profile, light_outside_the_panel_is_dark) {
  const Profile profile(std::vector<double>(40, 1.0), 0.6);
  EXPECT_NEAR(profile.mean(-0.5, 0, 0), 0.5, 1e-9);
  EXPECT_NEAR(profile.mean(39.5, 0, 0), 0.5, 1e-9);
  EXPECT_NEAR(profile.mean(20, 1, 0.3), 1, 1e-9);
  EXPECT_NEAR(profile.mean(-500, 1, 1), 0, 1e-9);
  EXPECT_NEAR(profile.mean(900, 1, 1), 0, 1e-9);
}

}  // namespace
}  // namespace raysteer::calib::synth
