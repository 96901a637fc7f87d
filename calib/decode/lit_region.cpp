#include "calib/decode/lit_region.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace raysteer::calib::decode {
namespace {

constexpr int kStep = 8;          // px between the places looked at
constexpr double kLit = 0.2;      // of what the brightest places gain from the light
constexpr double kStray = 0.005;  // of the lit places, on each side, may lie outside
constexpr std::size_t kFewest = 50;

struct Place {
  int x = 0;
  int y = 0;
  int gain = 0;
};

struct Span {
  int first = 0;
  int count = 0;
};

Span span(std::vector<int> values, int end) {
  std::ranges::sort(values);
  const auto stray = static_cast<std::size_t>(kStray * static_cast<double>(values.size()));
  const int first = std::max(0, values[stray] - kStep);
  return {first, std::min(end, values[values.size() - 1 - stray] + kStep + 1) - first};
}

template <class Pixel>
Region find(ImageView<const Pixel> white, ImageView<const Pixel> black) {
  std::vector<Place> places;
  std::vector<int> gains;
  for (int y = 0; y < white.height(); y += kStep) {
    for (int x = 0; x < white.width(); x += kStep) {
      places.push_back({x, y, static_cast<int>(white(x, y)) - static_cast<int>(black(x, y))});
      gains.push_back(places.back().gain);
    }
  }
  const Region all{0, 0, white.width(), white.height()};
  if (places.empty()) {
    return all;
  }
  const auto bright = gains.begin() + static_cast<std::ptrdiff_t>(0.995 * static_cast<double>(gains.size() - 1));
  std::ranges::nth_element(gains, bright);
  std::vector<int> columns;
  std::vector<int> rows;
  for (const Place& place : places) {
    if (place.gain > 0 && place.gain > kLit * *bright) {
      columns.push_back(place.x);
      rows.push_back(place.y);
    }
  }
  if (columns.size() < kFewest) {
    return all;
  }
  const Span across = span(std::move(columns), white.width());
  const Span down = span(std::move(rows), white.height());
  return {across.first, down.first, across.count, down.count};
}

}  // namespace

Region lit_region(ImageView<const std::uint8_t> white, ImageView<const std::uint8_t> black) {
  return find(white, black);
}

Region lit_region(ImageView<const std::uint16_t> white, ImageView<const std::uint16_t> black) {
  return find(white, black);
}

}  // namespace raysteer::calib::decode
