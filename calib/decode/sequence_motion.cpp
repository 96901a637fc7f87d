#include "calib/decode/sequence_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace raysteer::calib::decode {
namespace {

// Two passes of a box of 3: wide enough for shifts of a pixel or two, narrow enough for tiles of 24.
constexpr int kBorder = 3;  // px lost to smoothing and gradients
// A step of the iteration is cut to this, since the linear model holds no further.
constexpr double kLongestStep = 1.5;
constexpr int kIterations = 6;
// Beyond this the shifted sample would leave the tile too often.
constexpr double kLongestShift = 6;
// The shift's own standard deviation must be below this, px, for the shift to count as known.
constexpr double kMostUncertain = 0.15;
// Stripes and steps of a sinusoid light a place alike to this part only (blur, stray light). On a bare floor, whose
// level falls off by less than that a pixel, it passes for movement: this much of it, px, is too much.
constexpr double kUnlikeLight = 0.005;
constexpr double kMostBiased = 0.5;
// "Changed": more than this many levels and this part of the local level.
constexpr float kChangedLevels = 16;
constexpr float kChangedPart = 0.25F;

void smooth_once(Tiles& tiles) {
  const int side = tiles.side;
  const auto area = static_cast<std::size_t>(side) * side;
  std::vector<float> rows(area);
  for (std::size_t base = 0; base < tiles.levels.size(); base += area) {
    float* tile = &tiles.levels[base];
    for (int y = 0; y < side; ++y) {
      for (int x = 0; x < side; ++x) {
        const int left = std::max(x - 1, 0);
        const int right = std::min(x + 1, side - 1);
        rows[y * side + x] = (tile[y * side + left] + tile[y * side + x] + tile[y * side + right]) / 3;
      }
    }
    for (int y = 0; y < side; ++y) {
      const float* above = &rows[std::max(y - 1, 0) * side];
      const float* below = &rows[std::min(y + 1, side - 1) * side];
      for (int x = 0; x < side; ++x) {
        tile[y * side + x] = (above[x] + rows[y * side + x] + below[x]) / 3;
      }
    }
  }
}

Tiles smoothed(Tiles tiles) {
  smooth_once(tiles);
  smooth_once(tiles);
  return tiles;
}

float median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Level at (x, y) of a tile, between pixels.
float sample(const float* tile, int side, double x, double y) {
  const int left = static_cast<int>(x);
  const int top = static_cast<int>(y);
  const auto u = static_cast<float>(x - left);
  const auto v = static_cast<float>(y - top);
  const float* at = tile + top * side + left;
  return (1 - v) * ((1 - u) * at[0] + u * at[1]) + v * ((1 - u) * at[side] + u * at[side + 1]);
}

}  // namespace

double Shift::length() const { return std::hypot(x, y); }

ShiftMeter::ShiftMeter(const Tiles& reference, const std::vector<std::uint8_t>& usable)
    : smooth_(smoothed(reference)),
      gradient_x_(reference.levels.size()),
      gradient_y_(reference.levels.size()),
      usable_(reference.levels.size()) {
  const int side = smooth_.side;
  const auto area = static_cast<std::size_t>(side) * side;
  std::vector<float> levels;
  for (std::size_t base = 0; base < smooth_.levels.size(); base += area) {
    for (int y = kBorder; y < side - kBorder; ++y) {
      for (int x = kBorder; x < side - kBorder; ++x) {
        const std::size_t i = base + static_cast<std::size_t>(y * side + x);
        bool all = true;  // smoothing mixes neighbours in
        for (int dy = -2; dy <= 2; ++dy) {
          for (int dx = -2; dx <= 2; ++dx) {
            all = all && usable[base + static_cast<std::size_t>((y + dy) * side + x + dx)] != 0;
          }
        }
        usable_[i] = all ? 1 : 0;
        gradient_x_[i] = (smooth_.levels[i + 1] - smooth_.levels[i - 1]) / 2;
        gradient_y_[i] =
            (smooth_.levels[i + static_cast<std::size_t>(side)] - smooth_.levels[i - static_cast<std::size_t>(side)]) /
            2;
        if (all) {
          levels.push_back(smooth_.levels[i]);
        }
      }
    }
  }
  typical_ = levels.empty() ? 0 : median_of(levels);
}

Shift ShiftMeter::measure(const Tiles& moved) const {
  Shift shift;
  if (typical_ <= 0) {
    return shift;
  }
  const Tiles other = smoothed(moved);
  const int side = smooth_.side;
  const auto area = static_cast<std::size_t>(side) * side;
  std::vector<float> differences;
  std::vector<std::size_t> places;
  std::vector<float> sizes;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    differences.clear();
    places.clear();
    for (std::size_t base = 0; base < other.levels.size(); base += area) {
      const float* tile = &other.levels[base];
      for (int y = kBorder; y < side - kBorder; ++y) {
        const double from_y = y + shift.y;
        if (from_y < 0 || from_y >= side - 1) {
          continue;
        }
        for (int x = kBorder; x < side - kBorder; ++x) {
          const std::size_t i = base + static_cast<std::size_t>(y * side + x);
          const double from_x = x + shift.x;
          if (usable_[i] == 0 || from_x < 0 || from_x >= side - 1) {
            continue;
          }
          differences.push_back(sample(tile, side, from_x, from_y) - smooth_.levels[i]);
          places.push_back(i);
        }
      }
    }
    if (differences.size() < 200) {
      return shift;
    }
    // Lamps drift: a common change of level is no movement.
    sizes = differences;
    const float common = median_of(sizes);
    for (std::size_t n = 0; n < differences.size(); ++n) {
      differences[n] -= common;
      sizes[n] = std::abs(differences[n]);
    }
    const float spread = std::max(1.4826F * median_of(sizes), 1.0F);
    // Cauchy weights; wide at first, when the differences are the shift itself.
    const float width = spread * (iteration < 2 ? 12.0F : 5.0F);
    std::array<double, 5> sums{};
    double squares = 0;
    double weights = 0;
    for (std::size_t n = 0; n < places.size(); ++n) {
      const double gx = gradient_x_[places[n]];
      const double gy = gradient_y_[places[n]];
      const double d = differences[n];
      const double weight = 1 / (1 + (d / width) * (d / width));
      sums[0] += weight * gx * gx;
      sums[1] += weight * gx * gy;
      sums[2] += weight * gy * gy;
      sums[3] += weight * gx * d;
      sums[4] += weight * gy * d;
      squares += weight * d * d;
      weights += weight;
    }
    const double determinant = sums[0] * sums[2] - sums[1] * sums[1];
    // Smoothing makes about 12 neighbours say the same.
    const double variance = 12 * squares / weights;
    const double worst = variance * std::max(sums[0], sums[2]) / std::max(determinant, 1e-12);
    const double mean = (sums[0] + sums[2]) / 2;
    const double weakest = mean - std::sqrt(std::max(mean * mean - determinant, 0.0));  // the smaller eigenvalue
    const double bias = kUnlikeLight * typical_ / std::sqrt(std::max(weakest / weights, 1e-12));
    shift.known = determinant > 0 && worst < kMostUncertain * kMostUncertain && bias < kMostBiased;
    if (!shift.known || iteration == kIterations) {
      std::size_t changed = 0;
      for (std::size_t n = 0; n < places.size(); ++n) {
        changed += std::abs(differences[n]) > kChangedLevels + kChangedPart * smooth_.levels[places[n]] ? 1 : 0;
      }
      shift.changed = static_cast<double>(changed) / static_cast<double>(places.size());
      return shift;
    }
    double step_x = -(sums[2] * sums[3] - sums[1] * sums[4]) / determinant;
    double step_y = -(sums[0] * sums[4] - sums[1] * sums[3]) / determinant;
    const double step = std::hypot(step_x, step_y);
    if (step > kLongestStep) {
      step_x *= kLongestStep / step;
      step_y *= kLongestStep / step;
    }
    shift.x = std::clamp(shift.x + step_x, -kLongestShift, kLongestShift);
    shift.y = std::clamp(shift.y + step_y, -kLongestShift, kLongestShift);
    if (step < 0.01) {
      iteration = kIterations - 1;  // one more look at what is left
    }
  }
  return shift;
}

}  // namespace raysteer::calib::decode
