#include "host/report/svg.hpp"

#include <fmt/core.h>

#include <cmath>

#include "host/report/html.hpp"

namespace raysteer::host::report {
namespace {

const char* anchor_name(Anchor anchor) {
  return anchor == Anchor::kStart ? "start" : anchor == Anchor::kMiddle ? "middle" : "end";
}

std::string attribute(std::string_view name, std::string_view value) {
  return value.empty() ? std::string() : fmt::format(" {}=\"{}\"", name, escape(value));
}

}  // namespace

Svg::Svg(double width, double height, std::string_view label)
    : text_(fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\" aria-label=\"{}\">\n", width, height,
                        escape(label))) {}

void Svg::rect(double x, double y, double width, double height, std::string_view fill, std::string_view title) {
  text_ += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"{}\"", x, y, width,
                       height, fill);
  text_ += title.empty() ? "/>\n" : fmt::format("><title>{}</title></rect>\n", escape(title));
}

void Svg::line(double x1, double y1, double x2, double y2, std::string_view style_class) {
  text_ += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\"{}/>\n", x1, y1, x2, y2,
                       attribute("class", style_class));
}

void Svg::circle(double x, double y, double radius, std::string_view fill) {
  text_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>\n", x, y, radius, fill);
}

void Svg::filled_path(std::string_view d, std::string_view fill, std::string_view title) {
  text_ += fmt::format("<path d=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"0.5\"", d, fill, fill);
  text_ += title.empty() ? "/>\n" : fmt::format("><title>{}</title></path>\n", escape(title));
}

void Svg::path(std::string_view d, std::string_view style_class) {
  if (!d.empty()) {
    text_ += fmt::format("<path d=\"{}\"{}/>\n", d, attribute("class", style_class));
  }
}

void Svg::text(double x, double y, std::string_view words, Anchor anchor, std::string_view style_class,
               std::string_view fill) {
  text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}{}>{}</text>\n", x, y, anchor_name(anchor),
                       attribute("class", style_class), attribute("fill", fill), escape(words));
}

void Svg::text_upwards(double x, double y, std::string_view words) {
  text_ += fmt::format("<text transform=\"translate({:.1f} {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n", x,
                       y, escape(words));
}

std::string Svg::take() { return text_ + "</svg>\n"; }

double nice_step(double range, int most) {
  if (!(range > 0) || !std::isfinite(range)) {
    return 1;
  }
  const double least = range / most;
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least * (1 - 1e-9)) {
      return factor * power;
    }
  }
  return 10 * power;
}

std::string tick_label(double value, double step) {
  if (std::abs(value) < step * 1e-6) {
    return "0";
  }
  if (step >= 1e6 || step < 1e-5) {
    return fmt::format("{:.1e}", value);
  }
  return fmt::format("{:.{}f}", value, step >= 1 ? 0 : static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

std::string brief(double value) {
  if (!std::isfinite(value)) {
    return "–";
  }
  const double size = std::abs(value);
  if (size == 0) {
    return "0";
  }
  if (size >= 1000 || size < 1e-4) {
    return size >= 1000 && size < 1e7 ? fmt::format("{:.0f}", value) : fmt::format("{:.2e}", value);
  }
  const int decimals = 2 - static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.{}f}", value, decimals > 0 ? decimals : 0);
}

}  // namespace raysteer::host::report
