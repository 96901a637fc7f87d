// A drawing of the floor that a rig lights, seen from above, axes in metres: a map in colour, and what stands there.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/report/rig_result.hpp"
#include "host/report/scale.hpp"

namespace raysteer::host::report {

enum class Symbol { kDot, kRing, kCross };

struct FloorMark {
  double x_m = 0, y_m = 0;
  Symbol symbol = Symbol::kDot;
  std::string label{};  ///< beside it; empty: none
};

struct FloorOutline {
  std::vector<double> corners_m{};  ///< x0, y0, x1, y1, ...
  std::string label{};              ///< in its middle
  bool good = true;                 ///< red where not
};

struct FloorDrawing {
  std::vector<FloorCell> cells{};
  std::string unit{};  ///< of the cells' colours, for the bar: "mm, 95 %"
  std::vector<FloorOutline> outlines{};
  std::vector<FloorMark> marks{};
  std::vector<FloorArrow> arrows{};
  std::string arrows_are{};  ///< for the legend: "predicted minus measured"
  std::string outlines_are{};
  std::string dots_are{}, rings_are{}, crosses_are{};
};

/// Nothing where there is nothing to draw. Arrows are drawn longer than they are by a round factor that the legend
/// states, with a measure.
std::string floor_map(const FloorDrawing& drawing, const Caption& caption);

}  // namespace raysteer::host::report
