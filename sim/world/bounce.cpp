#include "sim/world/bounce.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/world/rows.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

struct SmallLamp {
  std::size_t cell = 0;
  Vector3d p;
  Vector3d normal;     ///< on the side that is lit
  double candela = 0;  ///< straight up
  double size2 = 0;    ///< its cell's area on the surface, m2
};

constexpr double kLiftM = 1e-4;

}  // namespace

Bounce::Bounce(const Seen& seen, const Lamp& lamp, const optics::TrueProjector& projector, int threads)
    : width_(seen.width()),
      step_(std::max(seen.width() / 64, 2)),
      columns_((seen.width() - 1) / step_ + 2),
      rows_((seen.height() - 1) / step_ + 2),
      transfer_(nodes() * kCellsAcross * kCellsDown, 0.0F),
      seen_(nodes(), 0.0F) {
  const Shapes& shapes = seen.shapes();
  std::vector<SmallLamp> lamps;
  for (int j = 0; j < kCellsDown; ++j) {
    for (int i = 0; i < kCellsAcross; ++i) {
      const double wide = static_cast<double>(projector.width) / kCellsAcross;
      const double high = static_cast<double>(projector.height) / kCellsDown;
      const Vector2d x((i + 0.5) * wide - 0.5, (j + 0.5) * high - 0.5);
      const auto ray = lamp.path().leave(x);
      if (!ray || !ray->passage.through) {
        continue;
      }
      const std::uint32_t triangle = shapes.tracer().nearest(ray->origin, ray->direction);
      if (triangle == Tracer::kNothing) {
        continue;
      }
      const double distance = shapes.tracer().meets(ray->origin, ray->direction, triangle);
      const Vector3d p = ray->origin + distance * ray->direction;
      const Vector3d normal = shapes.normal(triangle, -ray->direction);
      const scene::Material& material = shapes.material(triangle);
      const double albedo = material.texture ? material.texture->albedo(shapes.uv(triangle, p)) : material.albedo;
      const double way2 = (lamp.centre() - p).squaredNorm();
      const double cosine = -normal.dot(ray->direction);
      const double lumens =
          projector.lumens / (kCellsAcross * kCellsDown) * std::pow(projector.lens.ray(x).z(), projector.fall_off);
      lamps.push_back({.cell = static_cast<std::size_t>(j * kCellsAcross + i),
                       .p = p,
                       .normal = normal,
                       .candela = albedo / std::numbers::pi * lumens,
                       .size2 = lumens / std::max(lamp.intensity(x) * cosine / way2, 1e-9)});
    }
  }
  for_rows(rows_, threads, [&](int first, int end) {
    std::vector<Tracer::Shadow> rays;
    std::vector<std::uint8_t> blocked;
    std::vector<std::pair<std::size_t, float>> lights;
    for (int row = first; row < end; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const int x = std::min(column * step_, width_ - 1);
        const int y = std::min(row * step_, seen.height() - 1);
        const Sight& sight = seen.row(y)[x];
        if (sight.triangle == Tracer::kNothing) {
          continue;
        }
        const auto node = static_cast<std::size_t>(row * columns_ + column);
        seen_[node] = 1;
        const Vector3d p = sight.p.cast<double>();
        const Vector3d normal = shapes.normal(sight.triangle, seen.centre() - p);
        rays.clear();
        lights.clear();
        for (const SmallLamp& from : lamps) {
          const Vector3d way = from.p - p;
          const double length2 = way.squaredNorm();
          const double here = normal.dot(way);
          const double there = -from.normal.dot(way);
          if (here <= 0 || there <= 0) {
            continue;
          }
          rays.push_back({(p + kLiftM * normal).cast<float>(), (from.p + kLiftM * from.normal).cast<float>()});
          lights.emplace_back(from.cell,
                              static_cast<float>(from.candela * here * there / length2 / (length2 + from.size2)));
        }
        blocked.resize(rays.size());
        shapes.tracer().blocked(rays, blocked);
        float* out = transfer_.data() + node * kCellsAcross * kCellsDown;
        for (std::size_t i = 0; i < lights.size(); ++i) {
          out[lights[i].first] += blocked[i] != 0 ? 0 : lights[i].second;
        }
      }
    }
  });
}

void Bounce::add(const hal::mock::PanelPicture& picture, int first_row, int end_row, float weight,
                 std::vector<float>& nodes) const {
  std::vector<double> light(kCellsAcross * kCellsDown, 0.0);
  std::vector<int> count(light.size(), 0);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const auto cell =
          static_cast<std::size_t>(y * kCellsDown / picture.height * kCellsAcross + x * kCellsAcross / picture.width);
      light[cell] += y >= first_row && y < end_row ? picture.light(x, y) : 0;
      ++count[cell];
    }
  }
  std::vector<float> mean;
  for (std::size_t cell = 0; cell < light.size(); ++cell) {
    mean.push_back(weight * static_cast<float>(light[cell] / std::max(count[cell], 1)));
  }
  for (std::size_t node = 0; node < nodes.size(); ++node) {
    const float* row = transfer_.data() + node * mean.size();
    float sum = 0;
    for (std::size_t cell = 0; cell < mean.size(); ++cell) {
      sum += row[cell] * mean[cell];
    }
    nodes[node] += sum;
  }
}

void Bounce::row(const std::vector<float>& nodes, int y, std::vector<float>& lux) const {
  const auto upper = static_cast<std::size_t>(y / step_ * columns_);
  const auto lower = upper + static_cast<std::size_t>(columns_);
  const float v = static_cast<float>(y % step_) / static_cast<float>(step_);
  lux.resize(static_cast<std::size_t>(width_));
  for (int x = 0; x < width_; ++x) {
    const auto i = static_cast<std::size_t>(x / step_);
    const float u = static_cast<float>(x % step_) / static_cast<float>(step_);
    const float a = (1 - u) * (1 - v) * seen_[upper + i];
    const float b = u * (1 - v) * seen_[upper + i + 1];
    const float c = (1 - u) * v * seen_[lower + i];
    const float d = u * v * seen_[lower + i + 1];
    const float sum = a + b + c + d;
    lux[static_cast<std::size_t>(x)] =
        sum > 0
            ? (a * nodes[upper + i] + b * nodes[upper + i + 1] + c * nodes[lower + i] + d * nodes[lower + i + 1]) / sum
            : 0;
  }
}

}  // namespace raysteer::sim::world
