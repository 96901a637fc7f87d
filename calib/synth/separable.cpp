#include "calib/synth/separable.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::calib::synth {
namespace {

/// Blur of light that bounced once more, projector px.
constexpr double kBounceBlur = 8;

double normal_integral(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

/// Panel pixels `line`, each evenly lit, seen at `place` through a Gaussian.
double blurred(const std::vector<double>& line, double place, double sigma) {
  const int last = static_cast<int>(line.size()) - 1;
  const int from = std::max(0, static_cast<int>(std::floor(place - 5 * sigma)));
  const int to = std::min(last, static_cast<int>(std::ceil(place + 5 * sigma)));
  double sum = 0;
  double below = from <= to ? normal_integral((from - 0.5 - place) / sigma) : 0;
  for (int i = from; i <= to; ++i) {
    const double above = normal_integral((i + 0.5 - place) / sigma);
    sum += line[static_cast<std::size_t>(i)] * (above - below);
    below = above;
  }
  return sum;
}

/// What each fed column's place shows when a panel has only `of - 1` of `of` columns: mirror j covers of / (of - 1)
/// columns. Rendered on a grid of columns, each the mean of the mirrors it touches.
std::vector<double> scaled(const std::vector<double>& line, int of, int dropped) {
  std::vector<double> mirrors;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (static_cast<int>(i) % of != dropped) {
      mirrors.push_back(line[i]);
    }
  }
  const double width = static_cast<double>(of) / (of - 1);
  std::vector<double> shown(line.size());
  for (std::size_t i = 0; i < line.size(); ++i) {
    for (std::size_t j = static_cast<std::size_t>(static_cast<double>(i) / width);
         j < mirrors.size() && static_cast<double>(j) * width < static_cast<double>(i) + 1; ++j) {
      const double from = std::max(static_cast<double>(i), static_cast<double>(j) * width);
      const double to = std::min(static_cast<double>(i) + 1, static_cast<double>(j + 1) * width);
      shown[i] += std::max(0.0, to - from) * mirrors[j];
    }
  }
  return shown;
}

}  // namespace

std::vector<double> SeparableCamera::light(const Pattern& pattern, bool along_x) const {
  const int panel = along_x ? sequence_.panel_width : sequence_.panel_height;
  std::vector<double> line(static_cast<std::size_t>(panel));
  for (int i = 0; i < panel; ++i) {
    line[static_cast<std::size_t>(i)] = along_x ? pattern.value(i, 0) : pattern.value(0, i);
  }
  if (along_x && view_.dropped_of > 1) {
    line = scaled(line, view_.dropped_of, view_.dropped_column);
  }
  const int count = along_x ? view_.width : view_.height;
  std::vector<double> seen(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    const double place = along_x ? x(k) : y(k);
    const double direct = blurred(line, place, view_.blur_px);
    const double bounced = view_.interreflection > 0 ? blurred(line, panel - 1 - place, kBounceBlur) : 0;
    seen[static_cast<std::size_t>(k)] = (1 - view_.interreflection) * direct + view_.interreflection * bounced;
  }
  return seen;
}

Image<std::uint16_t> SeparableCamera::frame(const Pattern& pattern, Noise& noise) const {
  const bool coded = pattern.block.kind == PatternKind::kGray || pattern.block.kind == PatternKind::kPhase;
  const bool along_x = !coded || pattern.block.axis == Axis::kX;
  const std::vector<double> line = light(pattern, along_x);
  const double electrons_per_dn = view_.white_electrons / view_.white_dn;
  const double most = std::ldexp(1.0, view_.bits) - 1;
  Image<std::uint16_t> image(view_.width, view_.height);
  for (int v = 0; v < view_.height; ++v) {
    for (int u = 0; u < view_.width; ++u) {
      const double mean = view_.ambient_dn + view_.white_dn * line[static_cast<std::size_t>(along_x ? u : v)];
      const double sigma = std::sqrt(view_.read_sigma_dn * view_.read_sigma_dn + mean / electrons_per_dn);
      const double value = std::round(mean + sigma * noise.normal());
      image(u, v) = static_cast<std::uint16_t>(std::clamp(value, 0.0, most));
    }
  }
  return image;
}

Image<std::uint8_t> SeparableCamera::frame8(const Pattern& pattern, Noise& noise) const {
  const Image<std::uint16_t> wide = frame(pattern, noise);
  Image<std::uint8_t> image(view_.width, view_.height);
  std::transform(wide.data(), wide.data() + wide.size(), image.data(),
                 [](std::uint16_t value) { return static_cast<std::uint8_t>(value); });
  return image;
}

}  // namespace raysteer::calib::synth
