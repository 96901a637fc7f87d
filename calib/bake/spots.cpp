#include "calib/bake/spots.hpp"

#include <algorithm>

namespace raysteer::calib::bake {

Spots::Spots(const StationView& view, const PanelRays& rays)
    : width_(rays.lens().width), rows_(static_cast<std::size_t>(rays.lens().height)) {
  std::vector<PanelRay> row(static_cast<std::size_t>(width_));
  std::vector<std::optional<Placed>> placed;
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width_; ++x) {
      row[static_cast<std::size_t>(x)] = rays(x, y);
    }
    view.lit(row, placed);
    const auto is_lit = [](const auto& one) { return one.has_value(); };
    const auto first = std::ranges::find_if(placed, is_lit);
    if (first == placed.end()) {
      continue;
    }
    const auto end = std::find_if(placed.rbegin(), placed.rend(), is_lit).base();
    rows_[static_cast<std::size_t>(y)] = {.first = static_cast<int>(first - placed.begin()),
                                          .end = static_cast<int>(end - placed.begin()),
                                          .start = spots_.size()};
    for (auto one = first; one != end; ++one) {
      Spot spot;
      if (*one) {
        const Eigen::Vector2d content = (*one)->content();
        spot = {.u = content.x(), .v = content.y(), .light = (*one)->light};
        least_ = most_ == 0 ? spot.light : std::min(least_, spot.light);
        most_ = std::max(most_, spot.light);
      }
      spots_.push_back(spot);
    }
  }
}

}  // namespace raysteer::calib::bake
