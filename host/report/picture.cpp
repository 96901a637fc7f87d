#include "host/report/picture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "host/report/color.hpp"
#include "host/report/rgb_png.hpp"

namespace raysteer::host::report {
namespace {

constexpr int kMaxWidth = 900;

struct Cell {
  float x = 0, y = 0, z = 0;
  int points = 0;
};

using Vector = std::array<float, 3>;

Vector between(const Cell& from, const Cell& to) { return {to.x - from.x, to.y - from.y, to.z - from.z}; }

// Brightness of a surface spanned by two edges, lit from beside the viewer, who looks along z.
float shade(const Vector& a, const Vector& b) {
  const Vector n{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  if (length == 0) {
    return 0.6F;
  }
  // From above left, 35 degrees off the line of sight: shows relief without hiding slopes in shadow.
  constexpr Vector kLight{-0.4F, -0.4F, -0.82F};
  const float cosine = std::abs(n[0] * kLight[0] + n[1] * kLight[1] + n[2] * kLight[2]) / length;
  return 0.25F + 0.75F * cosine;
}

}  // namespace

std::string cloud_picture(std::span<const PanelPoint> points, int panel_width, int panel_height) {
  // Only the part of the panel that has points, so that a small object fills the picture.
  int left = panel_width, top = panel_height, right = -1, bottom = -1;
  std::vector<float> depths;
  for (const PanelPoint& point : points) {
    if (point.i >= 0 && point.j >= 0 && point.i < panel_width && point.j < panel_height && std::isfinite(point.z)) {
      left = std::min(left, point.i);
      right = std::max(right, point.i);
      top = std::min(top, point.j);
      bottom = std::max(bottom, point.j);
      depths.push_back(point.z);
    }
  }
  if (depths.empty()) {
    return {};
  }
  const auto quantile = [&depths](double q) {
    const auto nth = depths.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), nth, depths.end());
    return *nth;
  };
  const float nearest = quantile(0.01);
  const float farthest = std::max(quantile(0.99), nearest + 1e-6F);

  const int step = (right - left) / kMaxWidth + 1;
  const int width = (right - left) / step + 1;
  const int height = (bottom - top) / step + 1;
  std::vector<Cell> cells(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  const auto cell = [&](int x, int y) -> Cell& { return cells[static_cast<std::size_t>(y * width + x)]; };
  for (const PanelPoint& point : points) {
    if (point.i >= left && point.j >= top && point.i <= right && point.j <= bottom && std::isfinite(point.z)) {
      Cell& here = cell((point.i - left) / step, (point.j - top) / step);
      here.x += point.x;
      here.y += point.y;
      here.z += point.z;
      ++here.points;
    }
  }
  for (Cell& here : cells) {
    const float count = static_cast<float>(std::max(1, here.points));
    here.x /= count;
    here.y /= count;
    here.z /= count;
  }
  std::vector<std::uint8_t> rgb(cells.size() * 3, 255);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const Cell& here = cell(x, y);
      if (here.points == 0) {
        continue;
      }
      const Cell& beside = x + 1 < width && cell(x + 1, y).points > 0 ? cell(x + 1, y) : cell(std::max(0, x - 1), y);
      const Cell& below = y + 1 < height && cell(x, y + 1).points > 0 ? cell(x, y + 1) : cell(x, std::max(0, y - 1));
      const bool lonely = beside.points == 0 || below.points == 0 || &beside == &here || &below == &here;
      const float bright = lonely ? 0.6F : shade(between(here, beside), between(here, below));
      const Color color = sequential(static_cast<double>((here.z - nearest) / (farthest - nearest)));
      const std::size_t at = static_cast<std::size_t>(y * width + x) * 3;
      rgb[at] = static_cast<std::uint8_t>(static_cast<float>(color.r) * bright);
      rgb[at + 1] = static_cast<std::uint8_t>(static_cast<float>(color.g) * bright);
      rgb[at + 2] = static_cast<std::uint8_t>(static_cast<float>(color.b) * bright);
    }
  }
  return encode_rgb_png(rgb, width, height);
}

}  // namespace raysteer::host::report
