#include "host/report/figures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "host/report/html.hpp"
#include "host/report/scale.hpp"
#include "host/report/svg.hpp"

namespace raysteer::host::report {
namespace {

constexpr double kWidth = 460;  // of every figure, in SVG units; the page scales it
constexpr double kLeft = 44;    // room for tick labels
constexpr double kPlot = 340;   // plot's width where a colour bar stands beside it
constexpr double kTop = 6;
constexpr double kBottom = 26;
constexpr const char* kInk = "#20303c";

/// Device colours of bars: blue, orange, green (Okabe and Ito 2008, told apart by all readers).
constexpr std::array kDeviceColors{"#0072b2", "#e69f00", "#009e73", "#cc79a7"};

std::string figure(const Caption& caption, const std::string& drawing) { return figure_of(caption, drawing, false); }

double plot_height(int width, int height) { return std::clamp(kPlot * height / std::max(1, width), 90.0, 420.0); }

// The image's outline with ticks in pixels.
void image_axes(Svg& svg, int width, int height, double plot_h) {
  const double step = nice_step(std::max(width, height), 6);
  for (double x = 0; x <= width; x += step) {
    const double at = kLeft + kPlot * x / width;
    svg.line(at, kTop + plot_h, at, kTop + plot_h + 4, "axis");
    svg.text(at, kTop + plot_h + 16, fmt::format("{:.0f}", x), Anchor::kMiddle);
  }
  for (double y = 0; y <= height; y += step) {
    const double at = kTop + plot_h * y / height;
    svg.line(kLeft - 4, at, kLeft, at, "axis");
    svg.text(kLeft - 7, at + 3.5, fmt::format("{:.0f}", y), Anchor::kEnd);
  }
  svg.path(fmt::format("M{0} {1}h{2}v{3:.1f}h-{2}z", kLeft, kTop, kPlot, plot_h), "frame");
}

}  // namespace

std::string heat_map(const Grid& grid, int width, int height, std::string_view unit, Palette palette,
                     const Caption& caption) {
  const double plot_h = plot_height(width, height);
  Svg svg(kWidth, kTop + plot_h + kBottom, caption.title);
  const Scale scale = scale_of(grid.values, palette);
  const double cell_w = kPlot / std::max(1, grid.columns);
  const double cell_h = plot_h / std::max(1, grid.rows);
  const bool labels = cell_w >= 27 && cell_h >= 13;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const double value = grid.at(column, row);
      const double x = kLeft + column * cell_w;
      const double y = kTop + row * cell_h;
      if (!std::isfinite(value)) {
        svg.rect(x, y, cell_w, cell_h, "url(#hatch)");
        continue;
      }
      const Color color = scale.color(value);
      svg.rect(x, y, cell_w + 0.3, cell_h + 0.3, to_hex(color),
               labels ? std::string() : fmt::format("{} {}", brief(value), unit));
      if (labels) {
        const std::string number = value == std::floor(value) && std::abs(value) < 1e5 ? fmt::format("{:.0f}", value)
                                   : std::abs(value) >= 10                             ? fmt::format("{:.0f}", value)
                                   : std::abs(value) >= 1                              ? fmt::format("{:.1f}", value)
                                                                                       : fmt::format("{:.2f}", value);
        svg.text(x + cell_w / 2, y + cell_h / 2 + 3.2, number, Anchor::kMiddle, "cell",
                 color.is_dark() ? "#fff" : kInk);
      }
    }
  }
  image_axes(svg, width, height, plot_h);
  color_bar(svg, scale, unit, kLeft + kPlot + 14, kTop, plot_h);
  return figure(caption, svg.take());
}

std::string residual_field(const std::vector<ResidualVector>& residuals, int width, int height,
                           const std::string& title) {
  // So many arrows stay apart to the eye, and the page small.
  constexpr std::size_t kMost = 4000;
  const double plot_h = plot_height(width, height);
  const double to_plot = kPlot / std::max(1, width);
  std::vector<double> lengths;
  for (const ResidualVector& residual : residuals) {
    if (residual.kept) {
      lengths.push_back(std::hypot(residual.dx, residual.dy));
    }
  }
  double typical = 0.1;
  if (!lengths.empty()) {
    const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
    std::nth_element(lengths.begin(), middle, lengths.end());
    typical = std::max(*middle, 1e-6);
  }
  // A typical arrow is 9 units long; the factor is a round number.
  const double factor = nice_step(9 / (typical * to_plot), 1);
  const std::size_t every = residuals.size() / kMost + 1;
  std::string kept, dropped;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const ResidualVector& residual = residuals[i];
    if (residual.kept && i % every != 0) {
      continue;
    }
    double dx = residual.dx * factor * to_plot;
    double dy = residual.dy * factor * to_plot;
    // A gross error would cross the page; its colour says enough.
    if (const double length = std::hypot(dx, dy); length > 60) {
      dx *= 60 / length;
      dy *= 60 / length;
    }
    (residual.kept ? kept : dropped) +=
        fmt::format("M{:.1f} {:.1f}l{:.1f} {:.1f}", kLeft + (residual.x + 0.5) * to_plot,
                    kTop + (residual.y + 0.5) * to_plot, dx, dy);
  }
  Svg svg(kWidth, kTop + plot_h + kBottom, title);
  image_axes(svg, width, height, plot_h);
  svg.path(kept, "arrow");
  svg.path(dropped, "dropped");
  // A measure beside the plot.
  const double unit = nice_step(typical, 1);
  const double x = kLeft + kPlot + 14;
  svg.path(fmt::format("M{:.1f} {:.1f}h{:.1f}", x, kTop + 12, unit * factor * to_plot), "arrow measure");
  svg.text(x, kTop + 28, fmt::format("{} px", brief(unit)));
  const auto left_out = std::ranges::count(residuals, false, &ResidualVector::kept);
  std::string text = fmt::format(
      "From each measured corner towards where the model puts it, {} times as long as it is.", brief(factor));
  if (left_out > 0) {
    text += fmt::format(" Red: {} left out as outliers.", left_out);
  }
  if (every > 1) {
    text += fmt::format(" Every {}th kept corner is drawn.", every);
  }
  return figure({title, text + " A lens that fits leaves no pattern."}, svg.take());
}

Grid residual_grid(const std::vector<ResidualVector>& residuals, int width, int height) {
  Grid grid;
  grid.columns = 10;
  grid.rows = std::clamp(static_cast<int>(std::lround(10.0 * height / std::max(1, width))), 3, 12);
  const auto cells = static_cast<std::size_t>(grid.columns * grid.rows);
  std::vector<double> sum(cells);
  std::vector<int> count(cells);
  for (const ResidualVector& residual : residuals) {
    const int column = static_cast<int>(std::floor((residual.x + 0.5) / width * grid.columns));
    const int row = static_cast<int>(std::floor((residual.y + 0.5) / height * grid.rows));
    if (residual.kept && column >= 0 && row >= 0 && column < grid.columns && row < grid.rows) {
      const auto cell = static_cast<std::size_t>(row * grid.columns + column);
      sum[cell] += residual.dx * residual.dx + residual.dy * residual.dy;
      ++count[cell];
    }
  }
  for (std::size_t i = 0; i < cells; ++i) {
    // Fewer than three corners say nothing about a place.
    grid.values.push_back(count[i] < 3 ? kUnknown : std::sqrt(sum[i] / count[i]));
  }
  return grid;
}

std::string view_bars(const std::vector<ViewRow>& views, const std::vector<DeviceResult>& devices) {
  double most = 0;
  for (const ViewRow& view : views) {
    for (const double rms : view.rms_px) {
      most = std::isfinite(rms) ? std::max(most, rms) : most;
    }
  }
  if (views.empty() || !(most > 0)) {
    return {};
  }
  // One view far off must not flatten the others.
  std::vector<double> used;
  for (const ViewRow& view : views) {
    for (const double rms : view.rms_px) {
      if (view.used && std::isfinite(rms)) {
        used.push_back(rms);
      }
    }
  }
  const double top = used.empty() ? most : std::min(most, 2.5 * *std::ranges::max_element(used));
  constexpr double kFull = 960;
  constexpr double kHeight = 150;
  Svg svg(kFull, kHeight + 40, "RMS per view");
  const double step = nice_step(top, 4);
  for (double value = 0; value <= top * (1 + 1e-9); value += step) {
    const double y = kTop + kHeight * (1 - value / top);
    svg.line(kLeft, y, kFull, y, "grid");
    svg.text(kLeft - 7, y + 3.5, tick_label(value, step), Anchor::kEnd);
  }
  const double room = (kFull - kLeft) / static_cast<double>(views.size());
  const double bar = room * 0.8 / static_cast<double>(std::max<std::size_t>(1, devices.size()));
  // Names that would run into each other are shown at every second, third, ... view.
  std::size_t longest = 1;
  for (const ViewRow& view : views) {
    longest = std::max(longest, std::min<std::size_t>(view.name.size(), 16));
  }
  const auto label_every = static_cast<std::size_t>((6.5 * static_cast<double>(longest) + 6) / room) + 1;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double x = kLeft + (static_cast<double>(i) + 0.1) * room;
    for (std::size_t d = 0; d < views[i].rms_px.size() && d < devices.size(); ++d) {
      const double rms = views[i].rms_px[d];
      if (std::isfinite(rms)) {
        const double h = kHeight * std::min(rms, top) / top;
        svg.rect(x + static_cast<double>(d) * bar, kTop + kHeight - h, bar * 0.92, h,
                 views[i].used ? kDeviceColors[d % kDeviceColors.size()] : "#b8bfc6",
                 fmt::format("{}, {}: {} px", views[i].name, devices[d].name, brief(rms)));
      }
    }
    if (i % label_every == 0) {
      std::string name = views[i].name;
      if (name.size() > longest) {
        name = "…" + name.substr(name.size() - longest + 1);
      }
      svg.text(x + room * 0.4, kTop + kHeight + 15, name, Anchor::kMiddle);
    }
  }
  double x = kLeft;
  for (std::size_t d = 0; d < devices.size(); ++d) {
    svg.rect(x, kTop + kHeight + 23, 9, 9, kDeviceColors[d % kDeviceColors.size()]);
    svg.text(x + 13, kTop + kHeight + 31.5, devices[d].name);
    x += 30 + 7 * static_cast<double>(devices[d].name.size());
  }
  return fmt::format(
      "<figure class=\"wide\">\n{}<figcaption>RMS of each view in px. Grey: not used.</figcaption>\n</figure>\n",
      svg.take());
}

std::string histogram(const Histogram& histogram, std::string_view unit, const Caption& caption) {
  if (histogram.counts.empty() || !(histogram.high > histogram.low)) {
    return {};
  }
  constexpr double kHeight = 200;
  const double plot_w = kWidth - kLeft - 12;
  Svg svg(kWidth, kTop + kHeight + kBottom + 14, caption.title);
  const double most = static_cast<double>(std::max<std::int64_t>(1, *std::ranges::max_element(histogram.counts)));
  const double bar = plot_w / static_cast<double>(histogram.counts.size());
  const double range = histogram.high - histogram.low;
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    const double h = kHeight * static_cast<double>(histogram.counts[i]) / most;
    svg.rect(kLeft + static_cast<double>(i) * bar, kTop + kHeight - h, bar * 0.94, h, kDeviceColors[0]);
  }
  const double step = nice_step(range, 8);
  for (double value = std::ceil(histogram.low / step) * step; value <= histogram.high + 1e-9 * range; value += step) {
    const double x = kLeft + plot_w * (value - histogram.low) / range;
    svg.line(x, kTop + kHeight, x, kTop + kHeight + 4, "axis");
    svg.text(x, kTop + kHeight + 16, tick_label(value, step), Anchor::kMiddle);
  }
  svg.line(kLeft, kTop + kHeight, kLeft + plot_w, kTop + kHeight, "axis");
  if (histogram.low < 0 && histogram.high > 0) {
    const double zero = kLeft - plot_w * histogram.low / range;
    svg.line(zero, kTop, zero, kTop + kHeight, "zero");
  }
  svg.text(kLeft + plot_w / 2, kTop + kHeight + 32, unit, Anchor::kMiddle, "unit");
  return figure(caption, svg.take());
}

}  // namespace raysteer::host::report
