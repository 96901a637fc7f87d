#include "proto/stations/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raysteer::proto::stations {
namespace {

using Vec3 = std::array<double, 3>;
using Vec2 = std::array<double, 2>;

constexpr double kFlat = 0.01;  // of the extent

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Twice the area of a, b, c; above 0 against the clock.
double turn(const Vec2& a, const Vec2& b, const Vec2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool within(const Vec2& a, const Vec2& b, const Vec2& p) {
  return std::min(a[0], b[0]) <= p[0] && p[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= p[1] &&
         p[1] <= std::max(a[1], b[1]);
}

bool meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double ca = turn(a, b, c), da = turn(a, b, d), ac = turn(c, d, a), bc = turn(c, d, b);
  if (((ca > 0 && da < 0) || (ca < 0 && da > 0)) && ((ac > 0 && bc < 0) || (ac < 0 && bc > 0))) {
    return true;
  }
  return (ca == 0 && within(a, b, c)) || (da == 0 && within(a, b, d)) || (ac == 0 && within(c, d, a)) ||
         (bc == 0 && within(c, d, b));
}

bool crosses_itself(const std::vector<Vec2>& outline) {
  const std::size_t n = outline.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      if ((j + 1) % n != i && meet(outline[i], outline[i + 1], outline[j], outline[(j + 1) % n])) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::string polygon_fault(const std::vector<Vec3>& corners) {
  // Newell: the vector area is the sum over all edges, whatever the outline's shape.
  Vec3 area{};
  double extent = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3 a = minus(corners[i], corners[0]);
    const Vec3 piece = cross(a, minus(corners[(i + 1) % corners.size()], corners[0]));
    for (std::size_t k = 0; k < 3; ++k) {
      area[k] += piece[k] / 2;
    }
    extent = std::max(extent, std::sqrt(dot(a, a)));
  }
  const double size = std::sqrt(dot(area, area));
  if (!(size > 1e-9 * extent * extent) || !(size > 1e-8)) {
    return "encloses no area";
  }
  for (const Vec3& corner : corners) {
    if (std::abs(dot(area, minus(corner, corners[0]))) > kFlat * extent * size) {
      return "is not flat";
    }
  }
  // Onto the coordinates' plane that it faces most.
  std::size_t away = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    away = std::abs(area[k]) > std::abs(area[away]) ? k : away;
  }
  std::vector<Vec2> outline;
  for (const Vec3& corner : corners) {
    outline.push_back({corner[(away + 1) % 3], corner[(away + 2) % 3]});
  }
  return crosses_itself(outline) ? "has an outline that crosses itself" : "";
}

}  // namespace raysteer::proto::stations
