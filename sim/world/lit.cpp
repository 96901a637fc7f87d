#include "sim/world/lit.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "sim/world/blur_levels.hpp"
#include "sim/world/lattice.hpp"
#include "sim/world/rows.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

enum Way : std::uint8_t {
  kAway,     ///< no surface, turned away from the light, or far off the panel
  kBlocked,  ///< the panel points here, but a mirror's outline or a surface stops the light
  kOpen,
};

/// A box thinner than this is as good as none.
constexpr double kThinPx = 0.05;
constexpr double kCentroidUnit = 254;

/// Rows of camera rays, for the few pixels that need them.
struct Rays {
  int y = -1;
  CameraRays::Row row;
};

class Tracing {
 public:
  Tracing(const Seen& seen, const Lamp& lamp, Footprint* prints)
      : seen_(seen), lamp_(lamp), rays_(seen.camera()), prints_(prints), ways_(seen.width(), seen.height()) {}

  /// First: which panel pixel each camera pixel's centre looks at, and is the way open?
  void aim(int y);
  /// Then, from the neighbours: how wide the pixel lies on the panel and what light it gets. A footprint whose centre
  /// moves goes to `moved`, since the neighbours still look at the old one.
  void measure(int y, Rays& rays, std::vector<PartFootprint>& moved);
  void parts(int y, Rays& rays, std::vector<PartFootprint>& out) const;

 private:
  struct Sides {
    Vector2d across;
    Vector2d down;
  };

  Footprint* row(int y) const { return prints_ + static_cast<std::ptrdiff_t>(y) * seen_.width(); }
  Vector3d normal(const Sight& sight, const Vector3d& p) const {
    return seen_.shapes().normal(sight.triangle, seen_.centre() - p);
  }
  /// The shadow ray of a point that the lamp's light reaches if no surface is in the way.
  std::optional<Tracer::Shadow> reaches(const Vector3d& p, const Vector3d& normal) const {
    const auto by = lamp_.path().lit_by(p);
    if (!by || !by->passage.through) {
      return {};
    }
    return Tracer::shadow(p, normal, by->origin);
  }
  bool at_shadow_edge(int x, int y) const;
  /// Footprint sides from the rays instead of the neighbours.
  Sides sides(const Sight& sight, int x, int y, Rays& rays) const;
  Sides slides(const Sight& sight, int x, int y, Rays& rays, Vector3d& across, Vector3d& down) const;
  /// `share` of the pixel is lit, of which `reflect` electrons per second and lux come.
  void fill(Footprint& print, const Sight& sight, int x, int y, const Sides& sides, double share, double reflect) const;

  const Seen& seen_;
  const Lamp& lamp_;
  CameraRays rays_;
  Footprint* prints_;
  Image<std::uint8_t> ways_;
};

void Tracing::aim(int y) {
  const Sight* sights = seen_.row(y);
  Footprint* prints = row(y);
  std::uint8_t* ways = ways_.row(y);
  std::vector<Tracer::Shadow> shadows;
  std::vector<int> columns;
  for (int x = 0; x < seen_.width(); ++x) {
    ways[x] = kAway;
    if (sights[x].triangle == Tracer::kNothing) {
      continue;
    }
    const Vector3d p = sights[x].p.cast<double>();
    const Vector3d n = normal(sights[x], p);
    if (n.dot(lamp_.centre() - p) <= 0) {
      continue;
    }
    const auto at = lamp_.pixel(p);
    if (!at) {
      continue;
    }
    prints[x].x = static_cast<float>(at->x());
    prints[x].y = static_cast<float>(at->y());
    ways[x] = kBlocked;
    if (const auto shadow = reaches(p, n)) {
      shadows.push_back(*shadow);
      columns.push_back(x);
    }
  }
  std::vector<std::uint8_t> blocked(shadows.size());
  seen_.shapes().tracer().blocked(shadows, blocked);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    ways[columns[i]] = blocked[i] != 0 ? kBlocked : kOpen;
  }
}

bool Tracing::at_shadow_edge(int x, int y) const {
  const std::uint8_t way = ways_(x, y);
  const auto differs = [&](int to_x, int to_y, bool joins) {
    const std::uint8_t other = ways_(to_x, to_y);
    return joins && other != kAway && other != way;
  };
  const Sight* sights = seen_.row(y);
  return (x + 1 < seen_.width() && differs(x + 1, y, sights[x].joins_right)) ||
         (x > 0 && differs(x - 1, y, sights[x - 1].joins_right)) ||
         (y + 1 < seen_.height() && differs(x, y + 1, sights[x].joins_below)) ||
         (y > 0 && differs(x, y - 1, seen_.row(y - 1)[x].joins_below));
}

Tracing::Sides Tracing::slides(const Sight& sight, int x, int y, Rays& rays, Vector3d& across, Vector3d& down) const {
  if (rays.y != y) {
    rays_.row(y, rays.row);
    rays.y = y;
  }
  const auto at = static_cast<std::size_t>(x);
  const Vector3d p = sight.p.cast<double>();
  const Vector3d& n = seen_.shapes().tracer().normal(sight.triangle);
  across = slide(p - seen_.centre(), rays.row.ray[at], CameraRays::across(rays.row, x), n);
  down = slide(p - seen_.centre(), rays.row.ray[at], rays.row.down[at], n);
  const auto half = [&](const Vector3d& side) -> Vector2d {
    const auto ahead = lamp_.pixel(p + 0.5 * side);
    const auto behind = lamp_.pixel(p - 0.5 * side);
    return ahead && behind ? Vector2d(*ahead - *behind) : Vector2d(1, 1);  // at the very border of what is looked at
  };
  return {half(across), half(down)};
}

Tracing::Sides Tracing::sides(const Sight& sight, int x, int y, Rays& rays) const {
  Vector3d across, down;
  return slides(sight, x, y, rays, across, down);
}

void Tracing::fill(Footprint& print, const Sight& sight, int x, int y, const Sides& sides, double share,
                   double reflect) const {
  const Vector3d p = sight.p.cast<double>();
  const Vector3d to_camera = (seen_.centre() - p).normalized();
  const scene::Material& material = seen_.shapes().material(sight.triangle);
  const Lamp::Falls falls = lamp_.falls(p, normal(sight, p), {print.x, print.y}, material, to_camera);
  const double size = std::sqrt(share);
  const auto axis = [&](double a, double b, float& width, std::uint8_t& level) {
    const double longer = size * std::max(std::abs(a), std::abs(b));
    const double shorter = size * std::min(std::abs(a), std::abs(b));
    width = static_cast<float>(std::max(longer, kThinPx));
    level = blur_level(std::sqrt(falls.blur_px * falls.blur_px + shorter * shorter / 12));
  };
  axis(sides.across.x(), sides.down.x(), print.wide, print.blur_x);
  axis(sides.across.y(), sides.down.y(), print.high, print.blur_y);
  print.gain = static_cast<float>((reflect + falls.gloss * share * seen_.collects(x, y)) * falls.lux);
}

void Tracing::measure(int y, Rays& rays, std::vector<PartFootprint>& moved) {
  const int width = seen_.width();
  const Sight* sights = seen_.row(y);
  const Sight* sights_above = y > 0 ? seen_.row(y - 1) : nullptr;
  Footprint* prints = row(y);
  const std::uint8_t* ways = ways_.row(y);
  for (int x = 0; x < width; ++x) {
    if (ways[x] == kAway || sights[x].reflect == 0) {
      continue;
    }
    const bool edge = at_shadow_edge(x, y);
    if (ways[x] != kOpen && !edge) {
      continue;
    }
    const Sight& sight = sights[x];
    Footprint& print = prints[x];
    if (edge) {
      Vector3d across, down;
      const Sides sides = slides(sight, x, y, rays, across, down);
      const Vector3d p = sight.p.cast<double>();
      const Vector3d n = normal(sight, p);
      Vector2d centroid = Vector2d::Zero();
      int open = 0;
      for (const Vector2d& sample : samples()) {
        const auto shadow = reaches(p + sample.x() * across + sample.y() * down, n);
        if (shadow && !seen_.shapes().tracer().blocked(*shadow)) {
          centroid += sample;
          ++open;
        }
      }
      if (open == 0) {
        continue;
      }
      const double share = static_cast<double>(open) / kSamples;
      fill(print, sight, x, y, sides, share, sight.reflect * share);
      centroid /= open;
      PartFootprint part{print, x};
      part.at.x += static_cast<float>(sides.across.x() * centroid.x() + sides.down.x() * centroid.y());
      part.at.y += static_cast<float>(sides.across.y() * centroid.x() + sides.down.y() * centroid.y());
      moved.push_back(part);
      continue;
    }
    const auto step = [&](bool joins, int to_x, int to_y, int sign, Vector2d& side) {
      if (!joins || ways_(to_x, to_y) == kAway) {
        return false;
      }
      const Footprint& to = row(to_y)[to_x];
      side = sign * Vector2d(static_cast<double>(to.x) - print.x, static_cast<double>(to.y) - print.y);
      return true;
    };
    Sides found;
    const bool whole = (step(sight.joins_right, x + 1, y, 1, found.across) ||
                        (x > 0 && step(sights[x - 1].joins_right, x - 1, y, -1, found.across))) &&
                       (step(sight.joins_below, x, y + 1, 1, found.down) ||
                        (y > 0 && step(sights_above[x].joins_below, x, y - 1, -1, found.down)));
    if (!whole) {
      found = sides(sight, x, y, rays);
    }
    fill(print, sight, x, y, found, 1, sight.reflect);
    if (sight.right != 0 || sight.below != 0) {
      const double right = sight.right / kCentroidUnit;
      const double below = sight.below / kCentroidUnit;
      PartFootprint part{print, x};
      part.at.x += static_cast<float>(found.across.x() * right + found.down.x() * below);
      part.at.y += static_cast<float>(found.across.y() * right + found.down.y() * below);
      moved.push_back(part);
    }
  }
}

void Tracing::parts(int y, Rays& rays, std::vector<PartFootprint>& out) const {
  for (const PartSight& part : seen_.parts(y)) {
    const Vector3d p = part.sight.p.cast<double>();
    const Vector3d n = normal(part.sight, p);
    const auto at = lamp_.pixel(p);
    if (n.dot(lamp_.centre() - p) <= 0 || !at) {
      continue;
    }
    const auto shadow = reaches(p, n);
    if (!shadow || seen_.shapes().tracer().blocked(*shadow)) {
      continue;
    }
    PartFootprint print;
    print.column = part.x;
    print.at.x = static_cast<float>(at->x());
    print.at.y = static_cast<float>(at->y());
    fill(print.at, part.sight, part.x, y, sides(part.sight, part.x, y, rays), part.share, part.sight.reflect);
    out.push_back(print);
  }
}

}  // namespace

Lit::Lit(const Seen& seen, const Lamp& lamp, int threads)
    : width_(seen.width()),
      prints_(static_cast<std::size_t>(seen.width()) * static_cast<std::size_t>(seen.height())),
      levels_(kBlurLevels, false) {
  Tracing tracing(seen, lamp, prints_.data());
  const int height = seen.height();
  const auto rows = static_cast<std::size_t>(height);
  std::vector<std::vector<PartFootprint>> moved(rows);
  std::vector<std::vector<PartFootprint>> parts(rows);
  for_rows(height, threads, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      tracing.aim(y);
    }
  });
  for_rows(height, threads, [&](int first, int end) {
    Rays rays;
    for (int y = first; y < end; ++y) {
      tracing.measure(y, rays, moved[static_cast<std::size_t>(y)]);
      tracing.parts(y, rays, parts[static_cast<std::size_t>(y)]);
    }
  });
  const auto note = [this](const Footprint& print) {
    levels_[print.blur_x] = true;
    levels_[print.blur_y] = true;
    levels_[(print.blur_x + print.blur_y) / 2] = true;
  };
  for (std::size_t y = 0; y < rows; ++y) {
    Footprint* row = prints_.data() + y * static_cast<std::size_t>(width_);
    for (const PartFootprint& part : moved[y]) {
      row[part.column] = part.at;
    }
    for (int x = 0; x < width_; ++x) {
      if (row[x].gain > 0) {
        note(row[x]);
      }
    }
    first_part_.push_back(parts_.size());
    parts_.insert(parts_.end(), parts[y].begin(), parts[y].end());
  }
  first_part_.push_back(parts_.size());
  for (const PartFootprint& part : parts_) {
    note(part.at);
  }
}

}  // namespace raysteer::sim::world
