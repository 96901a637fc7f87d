#include "firmware/capture/grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <variant>

#include "hal/base/result.hpp"

namespace raysteer::firmware::capture {
namespace {

constexpr double kPlaces = 4000;

}  // namespace

Grid::Grid(int width, int height, int bits)
    : width_(width), height_(height), level_(1.0F / static_cast<float>((1U << static_cast<unsigned>(bits)) - 1)) {
  const double spacing = std::max(1.0, std::sqrt(static_cast<double>(width) * height / kPlaces));
  const int rows = std::max(1, static_cast<int>(height / spacing));
  const int columns = std::max(1, static_cast<int>(width / spacing));
  for (int row = 0; row < rows; ++row) {
    // The golden section spreads the rows' offsets evenly, however many there are.
    const double offset = row * std::numbers::phi - std::floor(row * std::numbers::phi);
    const auto y = static_cast<std::size_t>((row + 0.5) * height / rows);
    for (int column = 0; column < columns; ++column) {
      const auto x = static_cast<std::size_t>((column + offset) * width / columns);
      places_.push_back(y * static_cast<std::size_t>(width) + x);
    }
  }
}

Samples Grid::sample(const Frame& frame) const {
  return std::visit(
      [&](const auto& pixels) {
        RAYSTEER_CHECK(pixels.width() == width_ && pixels.height() == height_);
        Samples samples(places_.size());
        const auto* data = pixels.data();
        std::ranges::transform(places_, samples.begin(),
                               [&](std::size_t place) { return level_ * static_cast<float>(data[place]); });
        return samples;
      },
      frame);
}

float quantile(std::vector<float> values, double share) {
  if (values.empty()) {
    return 0;
  }
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

double mean(std::span<const float> values) {
  return values.empty() ? 0 : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace raysteer::firmware::capture
