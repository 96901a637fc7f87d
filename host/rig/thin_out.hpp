// pure: of many matches the best of each cell of a grid over the panel, and which are fit to be used.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <vector>

#include "calib/scene/match.hpp"
#include "host/scan/match_look.hpp"

namespace raysteer::host::rig {

/// Fewer points than this say little of a look's two angles.
inline constexpr std::size_t kFewestPoints = 20;

/// What decoding leaves behind beyond its noise is the same for neighbours, and many points together would pass it off
/// for a camera that moved: each place is given `floor_px` more.
inline Eigen::Matrix2d with_floor(const Eigen::Matrix2d& cov, double floor_px) {
  return cov + floor_px * floor_px * Eigen::Matrix2d::Identity();
}

/// At the rim of the light a place may be known across the stripes of one axis only.
inline bool known_both_ways(const Eigen::Matrix2d& cov) {
  return cov.allFinite() && cov.trace() > 0 && cov.determinant() > 1e-4 * cov.trace() * cov.trace();
}

/// `grid`: columns and rows. `usable` says which matches count. Pointers into `matched`.
template <class Usable>
std::vector<const calib::scene::Match*> best_of_cells(const scan::MatchedLook& matched, int panel_width,
                                                      int panel_height, std::array<int, 2> grid, Usable usable) {
  const auto badness = [](const calib::scene::Match& match) {
    return match.cov_left.trace() + match.cov_right.trace();
  };
  std::vector<const calib::scene::Match*> best(static_cast<std::size_t>(grid[0]) * static_cast<std::size_t>(grid[1]));
  for (const calib::scene::Match& match : matched.matches.measured) {
    if (!usable(match)) {
      continue;
    }
    const int column = std::min(match.i * matched.spacing * grid[0] / panel_width, grid[0] - 1);
    const int row = std::min(match.j * matched.spacing * grid[1] / panel_height, grid[1] - 1);
    const calib::scene::Match*& kept =
        best[static_cast<std::size_t>(row) * static_cast<std::size_t>(grid[0]) + static_cast<std::size_t>(column)];
    if (kept == nullptr || badness(match) < badness(*kept)) {
      kept = &match;
    }
  }
  std::erase(best, nullptr);
  return best;
}

}  // namespace raysteer::host::rig
