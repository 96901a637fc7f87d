#include "host/tour/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "host/tour/stroke_font.hpp"

namespace raysteer::host::tour {
namespace {

/// Catmull-Rom through all points, closed when the last is the first.
std::vector<Eigen::Vector2d> smooth(const std::vector<Eigen::Vector2d>& through) {
  constexpr int kPieces = 8;
  const auto n = static_cast<int>(through.size());
  const bool closed = n > 2 && through.front() == through.back();
  const auto at = [&](int i) {
    if (closed) {
      const int period = n - 1;
      return through[static_cast<std::size_t>(((i % period) + period) % period)];
    }
    return through[static_cast<std::size_t>(std::clamp(i, 0, n - 1))];
  };
  std::vector<Eigen::Vector2d> points{through.front()};
  for (int i = 0; i + 1 < n; ++i) {
    for (int piece = 1; piece <= kPieces; ++piece) {
      const double t = static_cast<double>(piece) / kPieces;
      const Eigen::Vector2d a = at(i - 1), b = at(i), c = at(i + 1), d = at(i + 2);
      points.emplace_back(
          0.5 * (2 * b + t * (c - a) + t * t * (2 * a - 5 * b + 4 * c - d) + t * t * t * (3 * b - a - 3 * c + d)));
    }
  }
  return points;
}

std::uint8_t mix(std::uint8_t below, std::uint8_t above, double opacity) {
  return static_cast<std::uint8_t>(std::lround(below + opacity * (above - below)));
}

}  // namespace

Canvas::Canvas(int width, int height, report::Color ground)
    : width_(width),
      height_(height),
      clip_{0, 0, width, height},
      rgb_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {
  for (std::size_t i = 0; i < rgb_.size(); i += 3) {
    rgb_[i] = ground.r;
    rgb_[i + 1] = ground.g;
    rgb_[i + 2] = ground.b;
  }
}

void Canvas::blend(int x, int y, report::Color color, double opacity) {
  if (opacity <= 0 || x < clip_[0] || y < clip_[1] || x >= clip_[2] || y >= clip_[3]) {
    return;
  }
  std::uint8_t* pixel = rgb_.data() + 3 * (static_cast<std::ptrdiff_t>(y) * width_ + x);
  pixel[0] = mix(pixel[0], color.r, opacity);
  pixel[1] = mix(pixel[1], color.g, opacity);
  pixel[2] = mix(pixel[2], color.b, opacity);
}

void Canvas::picture(ImageView<const std::uint8_t> grey, int x, int y, report::Color dark, report::Color light) {
  for (int row = 0; row < grey.height(); ++row) {
    for (int column = 0; column < grey.width(); ++column) {
      const double part = grey(column, row) / 255.0;
      blend(x + column, y + row, {mix(dark.r, light.r, part), mix(dark.g, light.g, part), mix(dark.b, light.b, part)},
            1);
    }
  }
}

void Canvas::line(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness, report::Color color,
                  double opacity) {
  const double half = 0.5 * thickness;
  // Clamped before they become int: a line may leave the picture by any length.
  const auto low = [&](double value, int least) {
    return static_cast<int>(std::max<double>(least, std::floor(value - half - 1)));
  };
  const auto high = [&](double value, int most) {
    return static_cast<int>(std::min<double>(most - 1, std::ceil(value + half + 1)));
  };
  const Eigen::Vector2d along = b - a;
  const double squared = along.squaredNorm();
  for (int y = low(std::min(a.y(), b.y()), clip_[1]); y <= high(std::max(a.y(), b.y()), clip_[3]); ++y) {
    for (int x = low(std::min(a.x(), b.x()), clip_[0]); x <= high(std::max(a.x(), b.x()), clip_[2]); ++x) {
      const Eigen::Vector2d p(x, y);
      const double t = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0.0;
      const double distance = (p - a - t * along).norm();
      blend(x, y, color, opacity * std::clamp(half + 0.5 - distance, 0.0, 1.0));
    }
  }
}

void Canvas::dashes(const Eigen::Vector2d& a, const Eigen::Vector2d& b, double thickness, double dash,
                    report::Color color) {
  const double length = (b - a).norm();
  const int pieces = std::max(1, static_cast<int>(std::lround(length / dash / 2)));
  for (int i = 0; i < pieces; ++i) {
    // A dash at both ends: n dashes and n - 1 gaps.
    const double unit = 1.0 / (2 * pieces - 1);
    line(a + 2 * i * unit * (b - a), a + (2 * i + 1) * unit * (b - a), thickness, color);
  }
}

void Canvas::fill(const std::array<Eigen::Vector2d, 4>& corners, report::Color color, double opacity) {
  Eigen::Vector2d least = corners[0], most = corners[0];
  double turn = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    least = least.cwiseMin(corners[i]);
    most = most.cwiseMax(corners[i]);
    const Eigen::Vector2d& next = corners[(i + 1) % 4];
    turn += corners[i].x() * next.y() - corners[i].y() * next.x();
  }
  for (int y = std::max(clip_[1], static_cast<int>(std::max(-1e6, least.y())) - 1); y < clip_[3] && y <= most.y() + 1;
       ++y) {
    for (int x = std::max(clip_[0], static_cast<int>(std::max(-1e6, least.x())) - 1); x < clip_[2] && x <= most.x() + 1;
         ++x) {
      double inside = 1;  // distance to the nearest side, as coverage
      for (std::size_t i = 0; i < 4; ++i) {
        const Eigen::Vector2d side = corners[(i + 1) % 4] - corners[i];
        const Eigen::Vector2d to = Eigen::Vector2d(x, y) - corners[i];
        const double distance = (side.x() * to.y() - side.y() * to.x()) / std::max(1e-9, side.norm());
        inside = std::min(inside, std::clamp((turn > 0 ? distance : -distance) + 0.5, 0.0, 1.0));
      }
      blend(x, y, color, opacity * inside);
    }
  }
}

double text_width(std::string_view words, double height) {
  double units = 0;
  for (const char letter : words) {
    const Glyph* shape = glyph(letter);
    units += (shape == nullptr ? 4 : shape->width) + kGapUnits;
  }
  return (units - kGapUnits) * height / kCapitalUnits;
}

void Canvas::text(const Eigen::Vector2d& at, std::string_view words, double height, double thickness,
                  report::Color color, Align align) {
  const double unit = height / kCapitalUnits;
  const double width = text_width(words, height);
  double x = at.x() - (align == Align::kMiddle ? 0.5 * width : align == Align::kRight ? width : 0);
  for (const char letter : words) {
    const Glyph* shape = glyph(letter);
    std::string_view strokes = shape == nullptr ? std::string_view{} : shape->strokes;
    while (!strokes.empty()) {
      const std::size_t end = std::min(strokes.find(' '), strokes.size());
      std::string_view stroke = strokes.substr(0, end);
      strokes.remove_prefix(std::min(end + 1, strokes.size()));
      const bool curved = stroke.starts_with('~');
      if (curved) {
        stroke.remove_prefix(1);
      }
      std::vector<Eigen::Vector2d> points;
      for (; stroke.size() >= 2; stroke.remove_prefix(2)) {
        points.emplace_back(x + unit * (stroke[0] - '0'), at.y() - unit * (stroke[1] - '0' - kBaseline));
      }
      if (curved) {
        points = smooth(points);
      }
      for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        line(points[i], points[i + 1], thickness, color);
      }
    }
    x += unit * ((shape == nullptr ? 4 : shape->width) + kGapUnits);
  }
}

}  // namespace raysteer::host::tour
