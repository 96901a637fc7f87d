#include "hal/base/noise.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace raysteer {
namespace {

/// z with P(Z < z) = p, by Newton's method on the distribution from its logistic approximation.
double normal_quantile(double p) {
  double z = 0.6 * std::log(p / (1 - p));
  for (int i = 0; i < 12; ++i) {
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    const double miss = 0.5 * std::erfc(-z / std::numbers::sqrt2) - p;
    const double newton = miss / density;
    z -= newton / (1 + z * newton / 2);  // Halley's correction keeps the tails from overshooting
  }
  return z;
}

constexpr std::size_t kCells = 4096;

/// Quantiles at the borders of equally likely cells; the first and last cell are the tails.
const std::array<double, kCells + 1>& quantiles() {
  static const std::array<double, kCells + 1> table = [] {
    std::array<double, kCells + 1> all{};
    for (std::size_t i = 1; i < kCells; ++i) {
      all[i] = normal_quantile(static_cast<double>(i) / kCells);
    }
    return all;
  }();
  return table;
}

}  // namespace

double Noise::normal() {
  static const std::array<double, kCells + 1>& table = quantiles();
  const std::uint64_t random = bits();
  const std::size_t cell = random >> 52U;
  const double within = static_cast<double>(random & 0xfffffffffffffU) * 0x1p-52;
  if (cell == 0 || cell == kCells - 1) {
    const double tail = (within + 0x1p-53) / kCells;
    return cell == 0 ? normal_quantile(tail) : -normal_quantile(tail);
  }
  return table[cell] + within * (table[cell + 1] - table[cell]);
}

}  // namespace raysteer
