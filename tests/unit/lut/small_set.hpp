// pure: a LUT set small enough to damage each of its bytes, with every kind of cell.
#pragma once

#include <cmath>
#include <random>
#include <stdexcept>

#include "proto/lut/lut_set.hpp"

namespace raysteer::proto::lut {

/// What a map's nodes are made from: content = (u, v) / w, each linear over the panel.
struct Homography {
  double u[3], v[3], w[3];

  double u_at(double x, double y) const { return (u[0] + u[1] * x + u[2] * y) / (w[0] + w[1] * x + w[2] * y); }
  double v_at(double x, double y) const { return (v[0] + v[1] * x + v[2] * y) / (w[0] + w[1] * x + w[2] * y); }
};

/// All cells kGrid; the gain falls from left to right.
inline WarpMapParts projective_parts(const Homography& h, int panel_width, int panel_height, int cell_px) {
  WarpMapParts parts;
  parts.name = "bench";
  parts.panel_width = panel_width;
  parts.panel_height = panel_height;
  parts.content_width = 1920;
  parts.content_height = 1200;
  parts.cell_px = cell_px;
  parts.exponent = 12;
  parts.bound_px = 0.05;
  parts.worst_px = 0.02;
  parts.command_nrad = {1'000'000, -2'000'000};
  parts.cells.assign(static_cast<std::size_t>(parts.columns() * parts.rows()), CellKind::kGrid);
  const double one = std::ldexp(1.0, 28);
  for (int row = 0; row <= parts.rows(); ++row) {
    for (int column = 0; column <= parts.columns(); ++column) {
      const double x = column * cell_px;
      const double y = row * cell_px;
      const auto fixed = [&](const double(&f)[3], double scale) {
        return static_cast<std::int32_t>(std::lround(scale * (f[0] + f[1] * x + f[2] * y)));
      };
      parts.nodes.push_back({.u = fixed(h.u, std::ldexp(one, -12)),
                             .v = fixed(h.v, std::ldexp(one, -12)),
                             .w = fixed(h.w, one),
                             .gain = static_cast<std::uint16_t>(32000 - 10 * column * cell_px)});
    }
  }
  return parts;
}

inline Homography random_homography(std::mt19937_64& random, int panel_width, int panel_height) {
  std::uniform_real_distribution<double> part(-1, 1);
  const double side = std::max(panel_width, panel_height);
  Homography h{{900 + 50 * part(random), 300 * part(random) / side, 300 * part(random) / side},
               {500 + 50 * part(random), 200 * part(random) / side, 200 * part(random) / side},
               {1, 0.15 * part(random) / side, 0.15 * part(random) / side}};
  return h;
}

template <class T>
T valid(Result<T> result) {
  if (!result) {
    throw std::runtime_error(result.error().message());
  }
  return std::move(*result);
}

inline SteeringTableParts small_steering_parts() {
  SteeringTableParts parts;
  parts.frame = Frame::kDatums;
  parts.origin = {-1, -0.5};
  parts.spacing_m = 0.5;
  parts.columns = 4;
  parts.rows = 3;
  parts.least_nrad = {-200'000'000, -100'000'000};
  parts.most_nrad = {200'000'000, 100'000'000};
  parts.bound_m = 1e-4;
  parts.worst_m = 5e-5;
  for (int row = 0; row < parts.rows; ++row) {
    for (int column = 0; column < parts.columns; ++column) {
      parts.nodes.push_back({100'000'000 * column - 150'000'000, 120'000'000 * row - 120'000'000});
    }
  }
  parts.reached = {1, 1, 1, 0, 1, 1};
  return parts;
}

/// One map of 20 x 12 pixels with a cell of each kind, a steering table, a zone.
inline LutSet small_set() {
  WarpMapParts parts = projective_parts({{900, 12, 3}, {500, -2, 9}, {1, 0.004, -0.002}}, 20, 12, 8);
  parts.cells = {CellKind::kGrid,  CellKind::kMasked, CellKind::kEmpty,  //
                 CellKind::kDense, CellKind::kMasked, CellKind::kGrid};
  parts.masks = {0xff, 0x0f, 0x01, 0x80, 0x00, 0x55, 0xaa, 0x3c, 1, 2, 4, 8, 16, 32, 64, 128};
  for (int i = 0; i < 64; ++i) {
    parts.dense.push_back(i % 9 == 0 ? WarpSample{} : WarpSample{.u = 100 * i, .v = 7000 - i, .gain = 5000});
  }
  LutSet set{.calibration_id = "4f1c",
             .board_id = "mock-galvo",
             .steering = valid(SteeringTable::make(small_steering_parts())),
             .keep_out = {{.name = "gangway", .corners = {{0, 0}, {1, 0}, {1, 1}, {0.5, 0.25}, {0, 1}}}},
             .maps = {}};
  set.maps.push_back(valid(WarpMap::make(parts)));
  parts.name = "second";
  parts.boost = 2;
  set.maps.push_back(valid(WarpMap::make(parts)));
  return set;
}

}  // namespace raysteer::proto::lut
