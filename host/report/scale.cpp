#include "host/report/scale.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "host/report/html.hpp"

namespace raysteer::host::report {

std::string figure_of(const Caption& caption, const std::string& drawing, bool wide) {
  return fmt::format("<figure{}>\n<h3>{}</h3>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                     wide ? " class=\"wide\"" : "", escape(caption.title), drawing, escape(caption.text));
}

Color Scale::color(double value) const {
  const double part = (value - low) / (high - low);
  switch (palette) {
    case Palette::kSequential:
      return sequential(part);
    case Palette::kDiverging:
      return diverging(2 * part - 1);
    case Palette::kSingle:
      break;
  }
  return single(part);
}

Scale scale_of(std::span<const double> values, Palette palette) {
  double least = HUGE_VAL, most = -HUGE_VAL;
  for (const double value : values) {
    if (std::isfinite(value)) {
      least = std::min(least, value);
      most = std::max(most, value);
    }
  }
  if (!(most >= least)) {
    return {0, 1, palette};
  }
  if (palette == Palette::kDiverging) {
    const double size = std::max({std::abs(least), std::abs(most), 1e-12});
    return {-size, size, palette};
  }
  const double low = palette == Palette::kSingle ? std::min(0.0, least) : least;
  return {low, most > low ? most : low + 1, palette};
}

void color_bar(Svg& svg, const Scale& scale, std::string_view unit, double x, double top, double height) {
  constexpr int kSteps = 40;
  for (int i = 0; i < kSteps; ++i) {
    const double value = scale.high - (scale.high - scale.low) * (i + 0.5) / kSteps;
    svg.rect(x, top + height * i / kSteps, 11, height / kSteps + 0.6, to_hex(scale.color(value)));
  }
  const double step = nice_step(scale.high - scale.low, 5);
  for (double value = std::ceil(scale.low / step) * step; value <= scale.high * (1 + 1e-9) + 1e-15; value += step) {
    const double at = top + height * (scale.high - value) / (scale.high - scale.low);
    svg.text(x + 15, at + 3.5, tick_label(value, step));
  }
  svg.text(x, top + height + 16, unit, Anchor::kStart, "unit");
}

}  // namespace raysteer::host::report
