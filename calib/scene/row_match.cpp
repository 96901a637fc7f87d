#include "calib/scene/row_match.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calib/scene/epipolar.hpp"

namespace raysteer::calib::scene {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
/// Neighbouring pixels of one surface see columns this close: four projector pixels a camera pixel at most ...
constexpr float kMostStep = 4;
constexpr std::size_t kFewestMatches = 100;
constexpr std::size_t kFewestInRow = 20;

bool valid(const decode::CodeMap& map, int u, int v) {
  return map.mask(u, v) == decode::kValid && std::isfinite(map.x(u, v));
}

/// A stretch between two neighbouring right pixels: columns [low, high].
struct Stretch {
  float low = 0, high = 0;
  float u_low = 0, u_high = 0;
};

std::vector<Stretch> stretches(const decode::CodeMap& map, int v) {
  std::vector<Stretch> row;
  for (int u = 0; u + 1 < map.x.width(); ++u) {
    if (!valid(map, u, v) || !valid(map, u + 1, v)) {
      continue;
    }
    const float a = map.x(u, v);
    const float b = map.x(u + 1, v);
    if (std::abs(b - a) < kMostStep && a != b) {
      const auto ua = static_cast<float>(u);
      row.push_back(a < b ? Stretch{a, b, ua, ua + 1} : Stretch{b, a, ua + 1, ua});
    }
  }
  std::ranges::sort(row, {}, &Stretch::low);
  return row;
}

/// Where the row shows column x; NaN where nowhere or at places more than a pixel apart.
float place(const std::vector<Stretch>& row, float x) {
  const auto from = std::ranges::lower_bound(row, x - kMostStep, {}, &Stretch::low);
  float least = kNone, most = kNone;
  for (auto s = from; s != row.end() && s->low <= x; ++s) {
    if (x <= s->high) {
      const float u = s->u_low + (s->u_high - s->u_low) * (x - s->low) / (s->high - s->low);
      least = std::fmin(least, u);
      most = std::fmax(most, u);
    }
  }
  // Noise can make a row show a column twice within a pixel or two; farther apart they are two surfaces.
  return most - least <= 2 ? (least + most) / 2 : kNone;
}

double percentile_95(std::vector<double>& values) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

}  // namespace

Result<RowMatches> match_rows(const decode::CodeMap& left, const decode::CodeMap& right) {
  if (left.x.empty() || right.x.empty()) {
    return fail(RCode::kNothingDecoded, "rows are matched by the projector's columns; the sequence codes none");
  }
  if (left.x.height() != right.x.height()) {
    return fail(RCode::kFrameSize, "rectified views have the same height; these have " +
                                       std::to_string(left.x.height()) + " and " + std::to_string(right.x.height()));
  }
  RowMatches matches;
  Image<float>& disparity = matches.disparity;
  disparity = Image<float>::uninitialised(left.x.width(), left.x.height());
  for (int v = 0; v < left.x.height(); ++v) {
    const std::vector<Stretch> row = stretches(right, v);
    for (int u = 0; u < left.x.width(); ++u) {
      disparity(u, v) = kNone;
      if (valid(left, u, v)) {
        ++matches.valid_left;
        disparity(u, v) = static_cast<float>(u) - place(row, left.x(u, v));
        matches.matched += std::isfinite(disparity(u, v)) ? 1 : 0;
      }
    }
  }
  if (matches.matched < kFewestMatches) {
    return fail(RCode::kTooFewMatches, std::to_string(matches.matched) + " pixels have a partner in their row");
  }

  std::vector<double> all, by_row, worst;
  for (int v = 1; v + 1 < disparity.height(); ++v) {
    by_row.clear();
    for (int u = 0; u < disparity.width(); ++u) {
      const float above = disparity(u, v - 1);
      const float below = disparity(u, v + 1);
      const auto departure = static_cast<double>(disparity(u, v) - (above + below) / 2) / std::sqrt(1.5);
      // A jump from above to below is a depth edge, not noise.
      if (std::isfinite(departure) && std::abs(above - below) < kMostStep) {
        by_row.push_back(departure);
      }
    }
    all.insert(all.end(), by_row.begin(), by_row.end());
    if (by_row.size() >= kFewestInRow) {
      std::ranges::transform(by_row, by_row.begin(), [](double value) { return std::abs(value); });
      worst.push_back(percentile_95(by_row));
    }
  }
  if (worst.empty()) {
    return fail(RCode::kTooFewMatches, "no row has " + std::to_string(kFewestInRow) + " matches with neighbours");
  }
  matches.rows = worst.size();
  matches.sigma_px = robust_sigma(all);
  std::ranges::transform(all, all.begin(), [](double value) { return std::abs(value); });
  matches.p95_px = percentile_95(all);
  matches.row_p95_worst_px = std::ranges::max(worst);
  const auto middle = worst.begin() + static_cast<std::ptrdiff_t>(worst.size() / 2);
  std::ranges::nth_element(worst, middle);
  matches.row_p95_median_px = *middle;
  return matches;
}

}  // namespace raysteer::calib::scene
