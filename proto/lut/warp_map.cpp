#include "proto/lut/warp_map.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::proto::lut {
namespace {

bool within(double value, double least, double most) { return value >= least && value <= most; }  // false for NaN

Status check_header(const WarpMapParts& parts) {
  if (parts.name.empty() || parts.name.size() > kLongestName) {
    return fail(RCode::kTableDamaged, "a warp map's name has 1 to 64 bytes, got " + std::to_string(parts.name.size()));
  }
  for (const int side : {parts.panel_width, parts.panel_height, parts.content_width, parts.content_height}) {
    if (side < 1 || side > kLargestSide) {
      return fail(RCode::kTableDamaged, "sides of panel and content are 1 to 16384 px, got " + std::to_string(side));
    }
  }
  if (parts.cell_px != 8 && parts.cell_px != 16 && parts.cell_px != 32 && parts.cell_px != 64) {
    return fail(RCode::kTableDamaged, "cells have 8, 16, 32 or 64 px, got " + std::to_string(parts.cell_px));
  }
  constexpr double kMost = 1e6;
  if (parts.exponent < -62 || parts.exponent > 62 || !within(parts.bound_px, 0, kMost) ||
      !within(parts.worst_px, 0, parts.bound_px) || !within(parts.gain_bound, 0, 1) || !within(parts.boost, 1, kMost) ||
      !within(parts.metres_per_px, 0, kMost) || !within(parts.tolerance_m, 0, kMost)) {
    return fail(RCode::kTableDamaged, "a number in the header of warp map '" + parts.name + "' is out of range");
  }
  return ok();
}

/// Content coordinates from one pixel before the content to one after: what evaluate() gives at most.
bool in_range(const WarpSample& sample, const WarpMapParts& parts) {
  return sample.u >= -kSubPixel && sample.u <= parts.content_width * kSubPixel && sample.v >= -kSubPixel &&
         sample.v <= parts.content_height * kSubPixel && sample.gain <= kFullGain;
}

}  // namespace

Result<WarpMap> WarpMap::make(WarpMapParts parts) {
  RAYSTEER_TRY(check_header(parts));
  const auto columns = static_cast<std::size_t>(parts.columns());
  const auto rows = static_cast<std::size_t>(parts.rows());
  const auto damaged = [&](const std::string& what) {
    return fail(RCode::kTableDamaged, what + " of warp map '" + parts.name + "' do not fit its size");
  };
  if (parts.cells.size() != columns * rows) {
    return damaged("cells");
  }
  if (parts.nodes.size() != (columns + 1) * (rows + 1)) {
    return damaged("nodes");
  }
  const std::size_t area = static_cast<std::size_t>(parts.cell_px) * static_cast<std::size_t>(parts.cell_px);
  std::vector<std::size_t> starts(parts.cells.size());
  std::size_t masks = 0;
  std::size_t dense = 0;
  for (std::size_t i = 0; i < parts.cells.size(); ++i) {
    const CellKind kind = parts.cells[i];
    if (kind > CellKind::kDense) {
      return damaged("kinds");
    }
    if (kind == CellKind::kMasked) {
      starts[i] = masks;
      masks += area / 8;
    } else if (kind == CellKind::kDense) {
      starts[i] = dense;
      dense += area;
    }
    if (kind == CellKind::kGrid || kind == CellKind::kMasked) {
      const std::size_t first = i / columns * (columns + 1) + i % columns;
      for (const std::size_t corner : {first, first + 1, first + columns + 1, first + columns + 2}) {
        if (parts.nodes[corner].w <= 0) {
          return damaged("weights");
        }
      }
    }
  }
  if (parts.masks.size() != masks) {
    return damaged("masks");
  }
  if (parts.dense.size() != dense ||
      !std::ranges::all_of(parts.dense, [&](const WarpSample& sample) { return in_range(sample, parts); })) {
    return damaged("dense pixels");
  }
  WarpMap map(std::move(parts));
  map.starts_ = std::move(starts);
  return map;
}

}  // namespace raysteer::proto::lut
