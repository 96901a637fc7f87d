// value: the lit pixels of one station, row by row; and the gain that makes them equally bright.
#pragma once

#include <vector>

#include "calib/bake/lit_content.hpp"

namespace raysteer::calib::bake {

struct Spot {
  double u = 0;  ///< content pixels
  double v = 0;
  double light = 0;  ///< 0: not lit
};

class Spots {
 public:
  Spots(const StationView& view, const PanelRays& rays);

  int width() const { return width_; }
  int height() const { return static_cast<int>(rows_.size()); }
  bool empty() const { return spots_.empty(); }
  double least_light() const { return least_; }
  double most_light() const { return most_; }
  /// A pixel of the panel, or null where nothing is lit.
  const Spot* at(int x, int y) const {
    const Row& row = rows_[static_cast<std::size_t>(y)];
    if (x < row.first || x >= row.end) {
      return nullptr;
    }
    const Spot& spot = spots_[row.start + static_cast<std::size_t>(x - row.first)];
    return spot.light > 0 ? &spot : nullptr;
  }
  /// Columns from the first lit to behind the last; none when equal.
  int first(int y) const { return rows_[static_cast<std::size_t>(y)].first; }
  int end(int y) const { return rows_[static_cast<std::size_t>(y)].end; }

 private:
  struct Row {
    int first = 0;
    int end = 0;
    std::size_t start = 0;
  };

  int width_;
  std::vector<Row> rows_;
  std::vector<Spot> spots_;
  double least_ = 0;
  double most_ = 0;
};

/// Share of its light that a place keeps, so that all become as bright as the darkest; `boost` limits how much is given
/// up for that.
class Gain {
 public:
  Gain(const Spots& spots, double boost)
      : wanted_(std::max(spots.least_light(), spots.most_light() / boost)), on_(boost > 1) {}
  double operator()(double light) const { return std::min(1.0, unlimited(light)); }
  /// Above 1 where light lacks: without a bend, for control points.
  double unlimited(double light) const { return on_ ? wanted_ / light : 1.0; }

 private:
  double wanted_;
  bool on_;
};

}  // namespace raysteer::calib::bake
