#include "sim/scene/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raysteer::sim::scene {
namespace {

// A quadrilateral of its own corners, in turn.
void add_quad(Mesh& mesh, const std::array<Eigen::Vector3d, 4>& corners) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

// An upright elliptic column with a flat top.
void add_column(Mesh& mesh, double radius_x, double radius_y, double bottom, double top) {
  constexpr int kSides = 16;
  const auto at = [&](int side, double z) {
    const double angle = 2 * std::numbers::pi * side / kSides;
    return Eigen::Vector3d(radius_x * std::cos(angle), radius_y * std::sin(angle), z);
  };
  for (int side = 0; side < kSides; ++side) {
    add_quad(mesh, {at(side, bottom), at(side + 1, bottom), at(side + 1, top), at(side, top)});
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {at(side, top), at(side + 1, top), Eigen::Vector3d(0, 0, top)});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
}

void add_box(Mesh& mesh, const Eigen::Vector3d& least, const Eigen::Vector3d& most) {
  const auto corner = [&](int x, int y, int z) {
    return Eigen::Vector3d(x == 0 ? least.x() : most.x(), y == 0 ? least.y() : most.y(), z == 0 ? least.z() : most.z());
  };
  add_quad(mesh, {corner(0, 0, 1), corner(1, 0, 1), corner(1, 1, 1), corner(0, 1, 1)});
  add_quad(mesh, {corner(0, 0, 0), corner(1, 0, 0), corner(1, 0, 1), corner(0, 0, 1)});
  add_quad(mesh, {corner(1, 0, 0), corner(1, 1, 0), corner(1, 1, 1), corner(1, 0, 1)});
  add_quad(mesh, {corner(1, 1, 0), corner(0, 1, 0), corner(0, 1, 1), corner(1, 1, 1)});
  add_quad(mesh, {corner(0, 1, 0), corner(0, 0, 0), corner(0, 0, 1), corner(0, 1, 1)});
}

}  // namespace

Mesh rectangle(double x0, double y0, double x1, double y1) {
  Mesh mesh;
  add_quad(mesh, {Eigen::Vector3d(x0, y0, 0), {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}});
  mesh.uv = {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
  return mesh;
}

Mesh box(const Eigen::Vector3d& size) {
  Mesh mesh;
  add_box(mesh, {-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()});
  return mesh;
}

Mesh stairs(int count, double depth, double width, double height) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    add_box(mesh, {i * depth, -width / 2, 0}, {(i + 1) * depth, width / 2, (i + 1) * height});
  }
  return mesh;
}

double door_height(double length, double width, double crown, double x, double y) {
  const double across = 2 * x / length;
  const double along = 2 * y / width;
  const double shell = crown * (1 - (across * across + along * along) / 2);
  const double crease = 0.15 * crown * std::exp(-std::abs(y - 0.15 * width) / (0.06 * width));
  const double bowl_x = (x - 0.25 * length) / (0.06 * length);
  const double bowl_y = (y - 0.02 * width) / (0.04 * width);
  return shell + crease - 0.3 * crown * std::exp(-bowl_x * bowl_x - bowl_y * bowl_y);
}

Mesh door(double length, double width, double crown, double cell) {
  const int columns = std::max(1, static_cast<int>(std::lround(length / cell)));
  const int rows = std::max(1, static_cast<int>(std::lround(width / cell)));
  Mesh mesh;
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const double x = length * (static_cast<double>(i) / columns - 0.5);
      const double y = width * (static_cast<double>(j) / rows - 0.5);
      mesh.vertices.emplace_back(x, y, door_height(length, width, crown, x, y));
      mesh.uv.emplace_back(x, y);
    }
  }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(j * (columns + 1) + i); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

Mesh person(double height) {
  Mesh mesh;
  add_column(mesh, 0.14 * height, 0.09 * height, 0, 0.84 * height);
  add_column(mesh, 0.05 * height, 0.06 * height, 0.84 * height, height);
  return mesh;
}

}  // namespace raysteer::sim::scene
