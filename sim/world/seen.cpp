#include "sim/world/seen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "sim/world/lattice.hpp"
#include "sim/world/light.hpp"
#include "sim/world/rows.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

/// Two points of one smooth surface lie in each other's tangent plane, to within this slope (11 degrees).
constexpr double kSmooth = 0.2;
constexpr double kCentroidUnit = 254;

/// Do the two pixels see the same smooth surface?
bool joined(const Shapes& shapes, const Sight& a, const Sight& b) {
  if (a.triangle == Tracer::kNothing || b.triangle == Tracer::kNothing) {
    return false;
  }
  if (a.triangle == b.triangle) {
    return true;
  }
  if (shapes.surface(a.triangle) != shapes.surface(b.triangle)) {
    return false;
  }
  const Vector3d step = (b.p - a.p).cast<double>();
  const double most = kSmooth * step.norm();
  return std::abs(shapes.tracer().normal(a.triangle).dot(step)) <= most &&
         std::abs(shapes.tracer().normal(b.triangle).dot(step)) <= most;
}

std::int8_t centroid(double px) { return static_cast<std::int8_t>(std::lround(px * kCentroidUnit)); }

}  // namespace

Seen::Seen(const optics::TrueCamera& camera, std::shared_ptr<const Shapes> shapes, int threads)
    : camera_(camera),
      centre_(camera.centre()),
      rays_(camera),
      collects_(camera.width, camera.height, 0, [&](const Vector2d& q) { return electrons_per_luminance(camera, q); }),
      shapes_(std::move(shapes)),
      sights_(camera.width, camera.height) {
  for_rows(height(), threads, [&](int first, int end) { trace(first, end); });
  for_rows(height(), threads, [&](int first, int end) { join(first, end); });
  // Shading looks only at the joins, so that a row may be changed while its neighbours are still to come.
  std::vector<std::vector<PartSight>> parts(static_cast<std::size_t>(height()));
  for_rows(height(), threads, [&](int first, int end) {
    std::vector<int> crossed;
    for (int y = first; y < end; ++y) {
      shade(y, parts[static_cast<std::size_t>(y)], crossed);
    }
  });
  for (const std::vector<PartSight>& row : parts) {
    first_part_.push_back(parts_.size());
    parts_.insert(parts_.end(), row.begin(), row.end());
  }
  first_part_.push_back(parts_.size());
}

void Seen::trace(int first_row, int end_row) {
  CameraRays::Row row;
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(width()));
  const Tracer& tracer = shapes_->tracer();
  for (int y = first_row; y < end_row; ++y) {
    rays_.row(y, row);
    tracer.nearest(centre_, row.ray, triangles);
    Sight* sights = sights_.row(y);
    for (int x = 0; x < width(); ++x) {
      const auto at = static_cast<std::size_t>(x);
      sights[x].triangle = triangles[at];
      if (triangles[at] != Tracer::kNothing) {
        const double s = tracer.meets(centre_, row.ray[at], triangles[at]);
        sights[x].p = (centre_ + s * row.ray[at]).cast<float>();
      }
    }
  }
}

void Seen::join(int first_row, int end_row) {
  for (int y = first_row; y < end_row; ++y) {
    Sight* sights = sights_.row(y);
    const Sight* below = y + 1 < height() ? sights_.row(y + 1) : nullptr;
    for (int x = 0; x < width(); ++x) {
      sights[x].joins_right = x + 1 < width() && joined(*shapes_, sights[x], sights[x + 1]);
      sights[x].joins_below = below != nullptr && joined(*shapes_, sights[x], below[x]);
    }
  }
}

void Seen::shade(int y, std::vector<PartSight>& parts, std::vector<int>& crossed) {
  crossed.clear();
  Sight* sights = sights_.row(y);
  const Sight* above = y > 0 ? sights_.row(y - 1) : nullptr;
  const bool last_row = y + 1 == height();
  CameraRays::Row row;
  for (int x = 0; x < width(); ++x) {
    Sight& sight = sights[x];
    const bool whole = (x == 0 || sights[x - 1].joins_right) && (x + 1 == width() || sight.joins_right) &&
                       (y == 0 || above[x].joins_below) && (last_row || sight.joins_below);
    if (!whole) {
      const bool empty = sight.triangle == Tracer::kNothing;
      const bool beside = (x > 0 && sights[x - 1].triangle != Tracer::kNothing) ||
                          (x + 1 < width() && sights[x + 1].triangle != Tracer::kNothing) ||
                          (above != nullptr && above[x].triangle != Tracer::kNothing) ||
                          (!last_row && sights_.row(y + 1)[x].triangle != Tracer::kNothing);
      if (!empty || beside) {
        crossed.push_back(x);
      }
      continue;
    }
    if (sight.triangle == Tracer::kNothing) {
      continue;
    }
    const scene::Material& material = shapes_->material(sight.triangle);
    Shapes::Albedo albedo{.mean = material.albedo};
    if (material.texture) {
      if (row.ray.empty()) {
        rays_.row(y, row);
      }
      const auto at = static_cast<std::size_t>(x);
      const Vector3d p = sight.p.cast<double>();
      const Vector3d& normal = shapes_->tracer().normal(sight.triangle);
      albedo = shapes_->albedo(sight.triangle, p, slide(p - centre_, row.ray[at], CameraRays::across(row, x), normal),
                               slide(p - centre_, row.ray[at], row.down[at], normal));
    }
    sight.reflect = static_cast<float>(albedo.mean / std::numbers::pi * collects_(x, y));
    sight.right = centroid(albedo.centroid.x());
    sight.below = centroid(albedo.centroid.y());
  }
  if (!crossed.empty() && row.ray.empty()) {
    rays_.row(y, row);
  }
  for (const int x : crossed) {
    const auto at = static_cast<std::size_t>(x);
    look(*shapes_, x, y, row.ray[at], CameraRays::across(row, x), row.down[at], parts);
  }
}

void Seen::look(const Shapes& shapes, int x, int y, const Vector3d& ray, const Vector3d& across, const Vector3d& down,
                std::vector<PartSight>& parts) const {
  std::array<Vector3d, kSamples> rays;
  std::array<std::uint32_t, kSamples> triangles;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    rays[i] = ray + samples()[i].x() * across + samples()[i].y() * down;
  }
  shapes.tracer().nearest(centre_, rays, triangles);

  struct Piece {
    Sight sight;
    Vector3d p = Vector3d::Zero();
    double albedo = 0;
    int count = 0;
  };
  std::array<Piece, 4> pieces;  // more surfaces than that in one pixel: the last takes the rest
  std::size_t used = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const std::uint32_t triangle = triangles[i];
    if (triangle == Tracer::kNothing) {
      continue;
    }
    const Vector3d p = centre_ + shapes.tracer().meets(centre_, rays[i], triangle) * rays[i];
    Sight sight;
    sight.p = p.cast<float>();
    sight.triangle = triangle;
    std::size_t piece = 0;
    while (piece < used && !joined(shapes, pieces[piece].sight, sight)) {
      ++piece;
    }
    if (piece == used && used < pieces.size()) {
      pieces[used++].sight = sight;
    }
    Piece& at = pieces[std::min(piece, pieces.size() - 1)];
    const scene::Material& material = shapes.material(triangle);
    at.albedo += material.texture ? material.texture->albedo(shapes.uv(triangle, p)) : material.albedo;
    at.p += p;
    ++at.count;
  }
  for (std::size_t i = 0; i < used; ++i) {
    Piece& piece = pieces[i];
    piece.sight.p = (piece.p / piece.count).cast<float>();
    piece.sight.reflect = static_cast<float>(piece.albedo / kSamples / std::numbers::pi * collects_(x, y));
    parts.push_back({piece.sight, x, y, static_cast<float>(piece.count) / kSamples});
  }
}

}  // namespace raysteer::sim::world
