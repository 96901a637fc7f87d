#include "hal/mock/gaussian_row.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include "hal/base/noise.hpp"

namespace raysteer::hal::mock {
namespace {

constexpr std::size_t kBits = 12;
constexpr std::size_t kCells = std::size_t{1} << kBits;
constexpr std::uint64_t kMask = kCells - 1;

double density(double z) { return std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi); }

/// The borders of kCells equally likely cells of the normal distribution, by Newton's method from the last border.
std::array<double, kCells + 1> borders() {
  std::array<double, kCells + 1> all{};
  all[kCells / 2] = 0;
  for (std::size_t i = kCells / 2 + 1; i < kCells; ++i) {
    double z = all[i - 1];
    for (int step = 0; step < 20; ++step) {
      const double above = 0.5 * std::erfc(z / std::numbers::sqrt2);
      z += (above - static_cast<double>(kCells - i) / kCells) / density(z);
    }
    all[i] = z;
    all[kCells - i] = -z;
  }
  all[0] = -40;
  all[kCells] = 40;
  return all;
}

/// The mean of each cell, then all scaled so that the table's variance is exactly 1/2.
const std::array<float, kCells>& half_normals() {
  static const std::array<float, kCells> table = [] {
    const std::array<double, kCells + 1> border = borders();
    std::array<double, kCells> mean{};
    double variance = 0;
    for (std::size_t i = 0; i < kCells; ++i) {
      mean[i] = kCells * (density(border[i]) - density(border[i + 1]));
      variance += mean[i] * mean[i] / kCells;
    }
    std::array<float, kCells> scaled{};
    for (std::size_t i = 0; i < kCells; ++i) {
      scaled[i] = static_cast<float>(mean[i] * std::sqrt(0.5 / variance));
    }
    return scaled;
  }();
  return table;
}

}  // namespace

void gaussian_row(std::uint64_t key, int row_number, std::span<float> row) {
  const float* table = half_normals().data();
  Noise noise(key, static_cast<std::uint64_t>(row_number));
  const std::size_t pairs = row.size() / 2;
  float* out = row.data();
  for (std::size_t i = 0; i < pairs; ++i, out += 2) {
    const std::uint64_t random = noise.bits();
    out[0] = table[random & kMask] + table[random >> kBits & kMask];
    out[1] = table[random >> (2 * kBits) & kMask] + table[random >> (3 * kBits) & kMask];
  }
  if (row.size() % 2 == 1) {
    const std::uint64_t random = noise.bits();
    *out = table[random & kMask] + table[random >> kBits & kMask];
  }
}

}  // namespace raysteer::hal::mock
