#include "calib/bake/warp.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/bake/spots.hpp"
#include "proto/lut/evaluate.hpp"

namespace raysteer::calib::bake {
namespace {

using proto::lut::CellKind;
using proto::lut::kFullGain;
using proto::lut::kSubPixel;
using proto::lut::WarpMap;
using proto::lut::WarpMapParts;
using proto::lut::WarpNode;
using proto::lut::WarpSample;
using proto::lut::WarpTile;

std::uint16_t fixed_gain(double gain, int most) {
  return static_cast<std::uint16_t>(std::clamp(std::lround(kFullGain * gain), 1L, long{most}));
}

WarpSample fixed_sample(const Spot& spot, const Gain& gain) {
  return {.u = static_cast<std::int32_t>(std::lround(kSubPixel * spot.u)),
          .v = static_cast<std::int32_t>(std::lround(kSubPixel * spot.v)),
          .gain = fixed_gain(gain(spot.light), kFullGain)};
}

/// A warp map of one cell size under construction.
class Layout {
 public:
  Layout(const StationView& view, const PanelRays& rays, const Spots& spots, const Gain& gain, WarpMapParts header)
      : view_(view), rays_(rays), spots_(spots), gain_(gain), parts_(std::move(header)) {
    sort_cells();
    set_nodes();
  }

  /// Looks every lit pixel up; cells that miss the bound become dense. False: so dense a map is off by more still.
  Result<WarpMap> checked(double bound_px, double gain_bound) {
    for (int round = 0; round < 2; ++round) {
      fill_masks_and_dense();
      auto map = WarpMap::make(parts_);
      RAYSTEER_TRY(map);
      if (judge(*map, bound_px, gain_bound)) {
        parts_.worst_px = worst_px_;
        return WarpMap::make(std::move(parts_));
      }
    }
    return fail(RCode::kTableBound, "station '" + parts_.name + "' cannot be kept within " + std::to_string(bound_px) +
                                        " px: fixed point alone is off by " + std::to_string(worst_px_) + " px");
  }
  std::size_t dense_pixels() const { return parts_.dense.size(); }

 private:
  std::size_t cell(int column, int row) const { return static_cast<std::size_t>(row * parts_.columns() + column); }
  std::size_t node(int column, int row) const {
    return static_cast<std::size_t>(row * (parts_.columns() + 1) + column);
  }
  int end_x(int column) const { return std::min((column + 1) * parts_.cell_px, parts_.panel_width); }
  int end_y(int row) const { return std::min((row + 1) * parts_.cell_px, parts_.panel_height); }

  void sort_cells();
  void set_nodes();
  void fill_masks_and_dense();
  bool judge(const WarpMap& map, double bound_px, double gain_bound);

  const StationView& view_;
  const PanelRays& rays_;
  const Spots& spots_;
  const Gain& gain_;
  WarpMapParts parts_;
  double worst_px_ = 0;
};

/// Empty, full or masked, by the lit pixels in each.
void Layout::sort_cells() {
  std::vector<int> lit(static_cast<std::size_t>(parts_.columns() * parts_.rows()));
  for (int y = 0; y < spots_.height(); ++y) {
    for (int x = spots_.first(y); x < spots_.end(y); ++x) {
      lit[cell(x / parts_.cell_px, y / parts_.cell_px)] += spots_.at(x, y) != nullptr ? 1 : 0;
    }
  }
  parts_.cells.resize(lit.size());
  for (int row = 0; row < parts_.rows(); ++row) {
    for (int column = 0; column < parts_.columns(); ++column) {
      const int all = (end_x(column) - column * parts_.cell_px) * (end_y(row) - row * parts_.cell_px);
      const int here = lit[cell(column, row)];
      parts_.cells[cell(column, row)] =
          here == 0 ? CellKind::kEmpty : (here == all ? CellKind::kGrid : CellKind::kMasked);
    }
  }
}

/// Control points around cells that are not empty. A cell that lacks one becomes dense.
void Layout::set_nodes() {
  const int columns = parts_.columns();
  const int rows = parts_.rows();
  std::vector<std::size_t> used;
  std::vector<PanelRay> rays;
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const auto shows = [&](int c, int r) {
        return c >= 0 && r >= 0 && c < columns && r < rows && parts_.cells[cell(c, r)] != CellKind::kEmpty;
      };
      if (shows(column - 1, row - 1) || shows(column, row - 1) || shows(column - 1, row) || shows(column, row)) {
        const int x = column * parts_.cell_px;
        const int y = row * parts_.cell_px;
        used.push_back(node(column, row));
        rays.push_back(x < parts_.panel_width && y < parts_.panel_height
                           ? rays_(x, y)
                           : panel_ray(rays_.lens(), Eigen::Vector2d(x, y)));
      }
    }
  }
  std::vector<std::optional<Placed>> placed;
  view_.place(rays, placed);
  double most_w = 0;
  double most_uv = 0;
  for (auto& one : placed) {
    if (one && !(one->uvw.z() > 0)) {
      one.reset();
    }
    if (one) {
      most_w = std::max(most_w, one->uvw.z());
      most_uv = std::max(most_uv, one->uvw.head<2>().cwiseAbs().maxCoeff());
    }
  }
  // The largest numbers fill 30 bits.
  constexpr double kFull = 1 << 30;
  const double scale_w = most_w > 0 ? kFull / most_w : 1;
  parts_.exponent =
      most_w > 0 && most_uv > 0 ? std::clamp(static_cast<int>(std::ceil(std::log2(most_uv / most_w))), -62, 62) : 0;
  const double scale_uv = std::ldexp(scale_w, -parts_.exponent);
  parts_.nodes.assign(static_cast<std::size_t>((columns + 1) * (rows + 1)), {});
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (placed[i] && std::lround(scale_w * placed[i]->uvw.z()) > 0) {
      const Eigen::Vector3d& uvw = placed[i]->uvw;
      parts_.nodes[used[i]] = {.u = static_cast<std::int32_t>(std::lround(scale_uv * uvw.x())),
                               .v = static_cast<std::int32_t>(std::lround(scale_uv * uvw.y())),
                               .w = static_cast<std::int32_t>(std::lround(scale_w * uvw.z())),
                               .gain = fixed_gain(gain_.unlimited(placed[i]->light), 65535)};
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      CellKind& kind = parts_.cells[cell(column, row)];
      for (const std::size_t corner :
           {node(column, row), node(column + 1, row), node(column, row + 1), node(column + 1, row + 1)}) {
        if (kind != CellKind::kEmpty && parts_.nodes[corner].w == 0) {
          kind = CellKind::kDense;
        }
      }
    }
  }
}

void Layout::fill_masks_and_dense() {
  parts_.masks.clear();
  parts_.dense.clear();
  const auto side = static_cast<std::size_t>(parts_.cell_px);
  for (int row = 0; row < parts_.rows(); ++row) {
    for (int column = 0; column < parts_.columns(); ++column) {
      const CellKind kind = parts_.cells[cell(column, row)];
      const bool masked = kind == CellKind::kMasked;
      if (!masked && kind != CellKind::kDense) {
        continue;
      }
      const std::size_t bits = parts_.masks.size();
      const std::size_t samples = parts_.dense.size();
      masked ? parts_.masks.resize(bits + side * side / 8) : parts_.dense.resize(samples + side * side);
      const int left = column * parts_.cell_px;
      for (int y = row * parts_.cell_px; y < end_y(row); ++y) {
        const std::size_t line = static_cast<std::size_t>(y - row * parts_.cell_px) * side;
        for (int x = left; x < end_x(column); ++x) {
          const Spot* spot = spots_.at(x, y);
          if (spot == nullptr) {
            continue;
          }
          const std::size_t i = line + static_cast<std::size_t>(x - left);
          if (masked) {
            std::uint8_t& byte = parts_.masks[bits + i / 8];
            byte = static_cast<std::uint8_t>(byte | 1U << (i % 8));
          } else {
            parts_.dense[samples + i] = fixed_sample(*spot, gain_);
          }
        }
      }
    }
  }
}

bool Layout::judge(const WarpMap& map, double bound_px, double gain_bound) {
  const auto tile = std::make_unique<WarpTile>();
  bool good = true;
  worst_px_ = 0;
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      if (map.kind(column, row) == CellKind::kEmpty) {
        continue;
      }
      evaluate(map, column, row, *tile);
      double worst = 0;
      double worst_gain = 0;
      for (int j = 0; j < tile->height; ++j) {
        for (int i = 0; i < tile->width; ++i) {
          const Spot* spot = spots_.at(tile->x + i, tile->y + j);
          const std::size_t at = WarpTile::at(i, j);
          RAYSTEER_CHECK((spot != nullptr) == (tile->gain[at] != 0));
          if (spot != nullptr) {
            const double du = tile->u[at] / double{kSubPixel} - spot->u;
            const double dv = tile->v[at] / double{kSubPixel} - spot->v;
            worst = std::max(worst, du * du + dv * dv);
            worst_gain = std::max(worst_gain, std::abs(tile->gain[at] / double{kFullGain} - gain_(spot->light)));
          }
        }
      }
      worst = std::sqrt(worst);
      if (worst > bound_px || worst_gain > gain_bound) {
        good = false;
        parts_.cells[cell(column, row)] = CellKind::kDense;
      }
      worst_px_ = std::max(worst_px_, worst);
    }
  }
  return good;
}

std::size_t bytes_of(const WarpMapParts& parts) {
  return parts.cells.size() + 14 * parts.nodes.size() + parts.masks.size() + 10 * parts.dense.size();
}

}  // namespace

Result<WarpMap> bake_warp(const StationView& view, const PanelRays& rays, const Eigen::Vector2d& command_rad,
                          const WarpOptions& options) {
  const Content& content = view.content();
  if (!(options.bound_px > 0 && options.bound_px < 1e6) || !(options.gain_bound > 0 && options.gain_bound < 1) ||
      !(options.boost >= 1 && options.boost <= 1e6) || !(options.light.fall_off >= 0)) {
    return fail(RCode::kBadValue, "bounds of a warp map must be positive, its boost at least 1");
  }
  const Spots spots(view, rays);
  if (spots.empty()) {
    return fail(RCode::kStationOutOfReach,
                "station '" + content.name + "': no pixel of the panel lights any of its content");
  }
  const Gain gain(spots, options.boost);
  WarpMapParts header;
  header.name = content.name;
  header.panel_width = rays.lens().width;
  header.panel_height = rays.lens().height;
  header.content_width = content.content_px.x();
  header.content_height = content.content_px.y();
  header.command_nrad = {static_cast<std::int32_t>(std::lround(1e9 * command_rad.x())),
                         static_cast<std::int32_t>(std::lround(1e9 * command_rad.y()))};
  header.bound_px = options.bound_px;
  header.gain_bound = options.gain_bound;
  header.boost = options.boost;
  header.metres_per_px = content.metres_per_px;
  header.tolerance_m = content.tolerance_m;
  std::optional<WarpMap> best;
  for (const int cell_px : {64, 32, 16, 8}) {
    header.cell_px = cell_px;
    Layout layout(view, rays, spots, gain, header);
    auto map = layout.checked(options.bound_px, options.gain_bound);
    RAYSTEER_TRY(map);
    const bool all_grid = map->parts().dense.empty();
    if (!best || bytes_of(map->parts()) < bytes_of(best->parts())) {
      best = std::move(*map);
    }
    if (all_grid) {
      break;  // smaller cells would only be more
    }
  }
  return std::move(*best);
}

}  // namespace raysteer::calib::bake
