// The sensor's noise against the exact law of a clipped and rounded normal variable.
#include "hal/mock/sensor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hal/mock/gaussian_row.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::hal::mock {
namespace {

struct Moments {
  double mean = 0;
  double variance = 0;
};

/// Of the numbers that `electrons` give, by adding up each number's probability.
Moments exact(double electrons, const SensorParameters& sensor) {
  const double most = std::ldexp(1.0, sensor.bits) - 1;
  const double black = sensor.black * most;
  const double scale = (most - black) / sensor.full_well_e;
  const double centre = black + scale * electrons;
  const double spread = scale * std::sqrt(electrons + sensor.read_noise_e * sensor.read_noise_e);
  const auto below = [&](double number) { return 0.5 * std::erfc((centre - number) / spread / std::numbers::sqrt2); };
  double sum = 0;
  double squares = 0;
  const int first = std::max(0, static_cast<int>(centre - 10 * spread) - 1);
  const int last = std::min(static_cast<int>(most), static_cast<int>(centre + 10 * spread) + 1);
  for (int n = first; n <= last; ++n) {
    const double p = (n == last ? 1 : below(n + 0.5)) - (n == first ? 0 : below(n - 0.5));
    sum += p * n;
    squares += p * n * n;
  }
  return {.mean = sum, .variance = squares - sum * sum};
}

Moments measured(double electrons, const SensorParameters& sensor, std::uint64_t key) {
  Image<float> flat(500, 400);
  flat.fill(static_cast<float>(electrons));
  const Frame frame = expose(flat.view(), sensor, 0, key, 1);
  double sum = 0;
  double squares = 0;
  std::visit(
      [&](const auto& pixels) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
          const double n = pixels.data()[i];
          sum += n;
          squares += n * n;
        }
      },
      frame);
  const double count = static_cast<double>(flat.size());
  return {.mean = sum / count, .variance = squares / count - sum / count * (sum / count)};
}

TEST(Sensor, has_the_right_mean_and_variance_from_darkness_to_full_well) {
  const std::uint64_t seed = support::seed();
  for (const int bits : {8, 12}) {
    const SensorParameters sensor{.bits = bits, .full_well_e = 10'000, .read_noise_e = 6, .response = {}};
    for (const double electrons : {0.0, 10.0, 100.0, 1'000.0, 3'333.0, 9'000.0, 9'950.0, 10'000.0}) {
      const Moments truth = exact(electrons, sensor);
      const Moments is = measured(electrons, sensor, seed + static_cast<std::uint64_t>(electrons));
      // 200,000 pixels: a mean is known to sigma / 447, a variance to 0.32 %, more where rounding makes it rare.
      const double rare = truth.variance < 0.05 ? 0.06 : 0.03;
      EXPECT_NEAR(is.variance, truth.variance, rare * truth.variance + 4e-4) << bits << " bits, " << electrons << " e";
      EXPECT_NEAR(is.mean, truth.mean, 5 * std::sqrt(truth.variance) / 447 + 1e-5 * truth.mean + 1e-4)
          << bits << " bits, " << electrons << " e";
    }
  }
}

TEST(Sensor, draws_numbers_with_the_moments_and_tails_of_a_normal_distribution) {
  const std::uint64_t seed = support::seed();
  constexpr int kRows = 100;
  constexpr int kCount = kRows * 10'000;
  std::vector<float> row(10'000);
  double sums[5] = {};
  int beyond3 = 0;
  int beyond4 = 0;
  double neighbours = 0;
  for (int y = 0; y < kRows; ++y) {
    gaussian_row(seed, y, row);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double z = row[i];
      double power = 1;
      for (double& sum : sums) {
        sum += power;
        power *= z;
      }
      beyond3 += std::abs(z) > 3 ? 1 : 0;
      beyond4 += std::abs(z) > 4 ? 1 : 0;
      neighbours += i > 0 ? z * row[i - 1] : 0;
    }
  }
  // Five standard deviations of each moment of a million draws: sqrt(1, 2, 15, 96) / 1000.
  EXPECT_NEAR(sums[1] / kCount, 0, 5e-3);
  EXPECT_NEAR(sums[2] / kCount, 1, 7.1e-3);
  EXPECT_NEAR(sums[3] / kCount, 0, 19.4e-3);
  EXPECT_NEAR(sums[4] / kCount, 3, 49e-3);
  EXPECT_NEAR(neighbours / kCount, 0, 5e-3);
  EXPECT_NEAR(beyond3, 2'700, 260);
  EXPECT_NEAR(beyond4, 58, 40);  // normal: 63; the table's tails are 8 % thin there
}

TEST(Sensor, gives_the_same_bytes_with_any_number_of_threads) {
  Image<float> ramp(333, 101);
  for (std::size_t i = 0; i < ramp.size(); ++i) {
    ramp.data()[i] = static_cast<float>(i % 11'000);
  }
  const auto bytes = [&](std::uint64_t key, int threads) {
    const Frame frame = expose(ramp.view(), {.response = {}}, 0, key, threads);
    const auto& pixels = std::get<Image<std::uint8_t>>(frame);
    return std::vector<std::uint8_t>(pixels.data(), pixels.data() + pixels.size());
  };
  EXPECT_EQ(bytes(7, 1), bytes(7, 2));
  EXPECT_EQ(bytes(7, 1), bytes(7, 5));
  EXPECT_NE(bytes(7, 1), bytes(8, 1));
}

TEST(Sensor, follows_its_response_and_gain) {
  const auto code = [](double electrons, const std::vector<float>& response, double gain_db) {
    SensorParameters sensor{.bits = 16, .full_well_e = 10'000, .read_noise_e = 0, .black = 0, .response = response};
    Image<float> flat(100, 100);
    flat.fill(static_cast<float>(electrons));
    const Frame frame = expose(flat.view(), sensor, gain_db, 3, 1);
    const auto& pixels = std::get<Image<std::uint16_t>>(frame);
    double sum = 0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      sum += pixels.data()[i];
    }
    return sum / static_cast<double>(pixels.size()) / 65'535;
  };
  EXPECT_NEAR(code(2'500, {}, 0), 0.25, 1e-3);
  EXPECT_NEAR(code(2'500, {}, 6.0206), 0.5, 2e-3);
  EXPECT_NEAR(code(2'500, {0, 0.5F, 1}, 0), 0.25, 1e-3);
  EXPECT_NEAR(code(2'500, {0, 0.8F, 1}, 0), 0.4, 2e-3);
  EXPECT_EQ(code(50'000, {}, 0), 1);
}

}  // namespace
}  // namespace raysteer::hal::mock
