#include "firmware/capture/grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>
#include <variant>

#include "hal/base/result.hpp"

namespace raysteer::firmware::capture {
namespace {

constexpr double kPlaces = 4000;
constexpr double kStray = 0.01;  // of the places, on each side

struct Span {
  int first = 0;
  int count = 0;
};

Span span_of(std::vector<float> values, int end) {
  const int first = static_cast<int>(quantile(values, kStray));
  return {first, std::min(end, static_cast<int>(quantile(std::move(values), 1 - kStray)) + 1) - first};
}

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

Region Grid::around(std::span<const std::uint32_t> places) const {
  if (places.empty()) {
    return {0, 0, width_, height_};
  }
  std::vector<float> columns;
  std::vector<float> rows;
  for (const std::uint32_t place : places) {
    const auto pixel = static_cast<std::int64_t>(places_[place]);
    columns.push_back(static_cast<float>(pixel % width_));
    rows.push_back(static_cast<float>(pixel / width_));
  }
  const Span across = span_of(std::move(columns), width_);
  const Span down = span_of(std::move(rows), height_);
  return {across.first, down.first, across.count, down.count};
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
