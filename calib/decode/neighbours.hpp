// Last look at a row: does each pixel agree with those around it? What is not valid loses its coordinate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/decode/code_map.hpp"

namespace raysteer::calib::decode {

/// A valid pixel that fewer than `fewest` of its 8 neighbours resemble in every code, to within `reach`, mixes two
/// surfaces or has a flipped bit: kEdge.
struct Resemblance {
  int reach_x = 0;
  int reach_y = 0;
  int fewest = 3;  ///< 0: nobody is asked. The side of a depth edge has three.
};

class RowCheck {
 public:
  RowCheck(CodeMap& map, const Resemblance& resemblance);
  /// Asks the neighbours of row v; codes of rows v - 1 to v + 1 must be there.
  void ask_neighbours(int v);
  /// Counts row v and takes coordinates from what is not valid. Nothing else may follow.
  void settle(int v);
  void row(int v) {
    ask_neighbours(v);
    settle(v);
  }

  std::size_t valid() const { return valid_; }
  std::size_t saturated() const { return saturated_; }
  /// Pixels that are neither in shadow nor weak nor saturated.
  std::size_t covered() const { return covered_; }

 private:
  CodeMap& map_;
  Resemblance resemblance_;
  std::vector<std::uint16_t> nothing_;  ///< codes of a row outside the image
  std::size_t valid_ = 0, saturated_ = 0, covered_ = 0;
};

}  // namespace raysteer::calib::decode
