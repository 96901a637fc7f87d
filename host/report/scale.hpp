// pure: values as colours, the bar that says which, and the frame around every drawing.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "host/report/color.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {

struct Caption {
  std::string title;
  std::string text;
};

/// An HTML figure: title, drawing, and how to read it. `wide`: across both columns.
std::string figure_of(const Caption& caption, const std::string& drawing, bool wide);

enum class Palette { kSingle, kSequential, kDiverging };

struct Scale {
  double low = 0;
  double high = 1;
  Palette palette = Palette::kSingle;
  Color color(double value) const;
};

/// From the least finite value to the most; from 0 for a single colour, symmetric about 0 when diverging.
Scale scale_of(std::span<const double> values, Palette palette);

/// A bar with ticks, its left edge at x; labels take 40 units to its right.
void color_bar(Svg& svg, const Scale& scale, std::string_view unit, double x, double top, double height);

}  // namespace raysteer::host::report
