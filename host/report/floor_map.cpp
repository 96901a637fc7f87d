#include "host/report/floor_map.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace raysteer::host::report {
namespace {

constexpr double kWidth = 960;
constexpr double kLeft = 52;
constexpr double kRight = 76;  // the colour bar and its labels
constexpr double kTop = 8;
constexpr double kTallest = 560;
constexpr double kBelow = 40;  // ticks and the axis's name
constexpr double kLegendRow = 18;
constexpr double kArrow = 22;     // a typical arrow's length, SVG units
constexpr double kLongest = 110;  // a gross error would cross the page

/// From metres on the floor to the drawing.
class Frame {
 public:
  void include(double x, double y) {
    if (std::isfinite(x) && std::isfinite(y)) {
      least_x_ = std::min(least_x_, x);
      most_x_ = std::max(most_x_, x);
      least_y_ = std::min(least_y_, y);
      most_y_ = std::max(most_y_, y);
    }
  }
  bool empty() const { return !(most_x_ >= least_x_); }
  /// `share` of the size is left free on every side.
  void settle(double share) {
    const double margin = share * std::max({most_x_ - least_x_, most_y_ - least_y_, 0.1});
    least_x_ -= margin, most_x_ += margin, least_y_ -= margin, most_y_ += margin;
    per_m_ = std::min((kWidth - kLeft - kRight) / (most_x_ - least_x_), kTallest / (most_y_ - least_y_));
  }
  double x(double metres) const { return kLeft + (metres - least_x_) * per_m_; }
  double y(double metres) const { return kTop + (most_y_ - metres) * per_m_; }
  double width() const { return (most_x_ - least_x_) * per_m_; }
  double height() const { return (most_y_ - least_y_) * per_m_; }
  double bottom() const { return kTop + height(); }
  double per_m() const { return per_m_; }

  void axes(Svg& svg) const {
    const double step = nice_step(std::max(most_x_ - least_x_, most_y_ - least_y_), 10);
    for (double at = std::ceil(least_x_ / step) * step; at <= most_x_; at += step) {
      svg.line(x(at), kTop, x(at), bottom(), "grid");
      svg.text(x(at), bottom() + 15, tick_label(at, step), Anchor::kMiddle);
    }
    for (double at = std::ceil(least_y_ / step) * step; at <= most_y_; at += step) {
      svg.line(kLeft, y(at), kLeft + width(), y(at), "grid");
      svg.text(kLeft - 6, y(at) + 3.5, tick_label(at, step), Anchor::kEnd);
    }
    svg.path(fmt::format("M{:.1f} {:.1f}h{:.1f}v{:.1f}h{:.1f}z", kLeft, kTop, width(), height(), -width()), "frame");
    svg.text(kLeft + width() / 2, bottom() + 31, "x, metres", Anchor::kMiddle, "unit");
    svg.text_upwards(13, kTop + height() / 2, "y, metres");
  }
  std::string path(const std::vector<double>& corners) const {
    std::string d;
    for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
      d += fmt::format("{}{:.1f} {:.1f}", i == 0 ? "M" : "L", x(corners[i]), y(corners[i + 1]));
    }
    return d.empty() ? d : d + "z";
  }

 private:
  double least_x_ = std::numeric_limits<double>::infinity(), most_x_ = -least_x_;
  double least_y_ = least_x_, most_y_ = -least_x_;
  double per_m_ = 1;
};

void include(Frame& frame, const std::vector<double>& corners) {
  for (std::size_t i = 0; i + 1 < corners.size(); i += 2) {
    frame.include(corners[i], corners[i + 1]);
  }
}

Frame frame_of(const FloorDrawing& drawing) {
  Frame frame;
  for (const FloorCell& cell : drawing.cells) {
    include(frame, cell.outline_m);
  }
  for (const FloorOutline& outline : drawing.outlines) {
    include(frame, outline.corners_m);
  }
  for (const FloorMark& mark : drawing.marks) {
    frame.include(mark.x_m, mark.y_m);
  }
  for (const FloorArrow& arrow : drawing.arrows) {
    frame.include(arrow.x_m, arrow.y_m);
  }
  return frame;
}

void symbol(Svg& svg, double x, double y, Symbol symbol) {
  switch (symbol) {
    case Symbol::kDot:
      svg.circle(x, y, 4.4, "#fff");  // seen on dark cells, too
      svg.circle(x, y, 3.2, "#20303c");
      break;
    case Symbol::kRing:
      svg.path(fmt::format("M{:.1f} {:.1f}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0", x - 4.5, y), "ring");
      break;
    case Symbol::kCross:
      svg.path(fmt::format("M{:.1f} {:.1f}h12m-6 -6v12", x - 6, y), "cross under");
      svg.path(fmt::format("M{:.1f} {:.1f}h10m-5 -5v10", x - 5, y), "cross");
      break;
  }
}

/// How much longer than they are arrows are drawn.
double exaggeration(const std::vector<FloorArrow>& arrows, double per_m) {
  std::vector<double> lengths;
  for (const FloorArrow& arrow : arrows) {
    const double length = std::hypot(arrow.dx_mm, arrow.dy_mm);
    if (std::isfinite(length)) {
      lengths.push_back(length);
    }
  }
  if (lengths.empty()) {
    return 1;
  }
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::ranges::nth_element(lengths, middle);
  return nice_step(kArrow / (std::max(*middle, 1e-3) * 1e-3 * per_m), 1);
}

std::string arrow_path(const Frame& frame, const FloorArrow& arrow, double factor) {
  double dx = arrow.dx_mm * 1e-3 * factor * frame.per_m();
  double dy = -arrow.dy_mm * 1e-3 * factor * frame.per_m();
  const double length = std::hypot(dx, dy);
  if (!std::isfinite(length)) {
    return {};
  }
  if (length > kLongest) {
    dx *= kLongest / length;
    dy *= kLongest / length;
  }
  std::string d = fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}", frame.x(arrow.x_m), frame.y(arrow.y_m), dx, dy);
  if (length > 6) {  // a head, 25 degrees to either side
    const double turn = std::atan2(dy, dx);
    const double head = std::min(6.0, 0.4 * length);
    for (const double side : {0.44, -0.44}) {
      d += fmt::format("m{:.1f} {:.1f}l{:.1f} {:.1f}", -head * std::cos(turn + side), -head * std::sin(turn + side),
                       head * std::cos(turn + side), head * std::sin(turn + side));
    }
  }
  return d;
}

/// The symbols' meanings, one after the other in rows.
class Legend {
 public:
  Legend(Svg& svg, double top) : svg_(svg), y_(top) {}
  template <class Draw>
  void add(const std::string& words, double picture, Draw draw) {
    if (words.empty()) {
      return;
    }
    const double needed = picture + 10 + 6.3 * static_cast<double>(words.size()) + 22;
    if (x_ > kLeft && x_ + needed > kWidth) {
      x_ = kLeft;
      y_ += kLegendRow;
    }
    draw(x_, y_);
    svg_.text(x_ + picture + 6, y_ + 4, words);
    x_ += needed;
  }

 private:
  Svg& svg_;
  double x_ = kLeft;
  double y_;
};

}  // namespace

std::string floor_map(const FloorDrawing& drawing, const Caption& caption) {
  Frame frame = frame_of(drawing);
  if (frame.empty()) {
    return {};
  }
  frame.settle(drawing.arrows.empty() ? 0.03 : 0.08);  // arrows begin inside and may end outside
  const double legend = frame.bottom() + kBelow + 12;
  Svg svg(kWidth, legend + 2 * kLegendRow, caption.title);
  std::vector<double> values;
  for (const FloorCell& cell : drawing.cells) {
    values.push_back(cell.mm);
  }
  const Scale scale = scale_of(values, Palette::kSingle);
  for (const FloorCell& cell : drawing.cells) {
    svg.filled_path(frame.path(cell.outline_m),
                    std::isfinite(cell.mm) ? to_hex(scale.color(cell.mm)) : std::string("url(#hatch)"),
                    fmt::format("{} mm", brief(cell.mm)));
  }
  frame.axes(svg);
  for (const FloorOutline& outline : drawing.outlines) {
    svg.path(frame.path(outline.corners_m), outline.good ? "station" : "station bad");
  }
  const double factor = exaggeration(drawing.arrows, frame.per_m());
  std::string arrows;
  for (const FloorArrow& arrow : drawing.arrows) {
    arrows += arrow_path(frame, arrow, factor);
  }
  svg.path(arrows, "vector");
  for (const FloorMark& mark : drawing.marks) {
    if (std::isfinite(mark.x_m) && std::isfinite(mark.y_m)) {
      symbol(svg, frame.x(mark.x_m), frame.y(mark.y_m), mark.symbol);
      svg.text(frame.x(mark.x_m) + 7, frame.y(mark.y_m) - 5, mark.label, Anchor::kStart, "halo");
    }
  }
  for (const FloorOutline& outline : drawing.outlines) {
    double x = 0, y = 0;
    const auto corners = static_cast<double>(outline.corners_m.size() / 2);
    for (std::size_t i = 0; i + 1 < outline.corners_m.size(); i += 2) {
      x += outline.corners_m[i] / corners;
      y += outline.corners_m[i + 1] / corners;
    }
    svg.text(frame.x(x), frame.y(y) + 4, outline.label, Anchor::kMiddle, "halo");
  }
  if (!drawing.cells.empty()) {
    color_bar(svg, scale, drawing.unit, kLeft + frame.width() + 14, kTop, frame.height());
  }
  Legend words(svg, legend);
  words.add(drawing.outlines.empty() ? "" : drawing.outlines_are, 16,
            [&](double x, double y) { svg.path(fmt::format("M{:.1f} {:.1f}h16v10h-16z", x, y - 5), "station"); });
  const auto mark = [&](Symbol which, const std::string& are) {
    const bool any = std::ranges::any_of(drawing.marks, [&](const FloorMark& one) { return one.symbol == which; });
    words.add(any ? are : "", 10, [&](double x, double y) { symbol(svg, x + 5, y, which); });
  };
  mark(Symbol::kDot, drawing.dots_are);
  mark(Symbol::kRing, drawing.rings_are);
  mark(Symbol::kCross, drawing.crosses_are);
  if (!drawing.arrows.empty()) {
    const double unit_mm = nice_step(kArrow / (factor * 1e-3 * frame.per_m()), 1);
    const double length = unit_mm * 1e-3 * factor * frame.per_m();
    words.add(fmt::format("{} mm: {}, drawn {} times as long", brief(unit_mm), drawing.arrows_are, brief(factor)),
              length, [&](double x, double y) {
                svg.path(fmt::format("M{:.1f} {:.1f}h{:.1f}m-5 -2.5l5 2.5l-5 2.5", x, y, length), "vector");
              });
  }
  return figure_of(caption, svg.take(), true);
}

}  // namespace raysteer::host::report
