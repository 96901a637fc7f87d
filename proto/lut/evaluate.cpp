#include "proto/lut/evaluate.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::proto::lut {
namespace {

/// Values along one row of a cell: `first` at its left edge, `step` a pixel.
struct Line {
  float first;
  float step;
};

struct RowLines {
  Line u, v, w, gain;
};

/// Not std::clamp: references keep GCC 12 from vectorising. What is no number becomes `most`.
[[gnu::always_inline]] inline float limited(float value, float least, float most) {
  const float lower = value < most ? value : most;
  return lower < least ? least : lower;
}

// Adding a pixel first keeps the number positive, so that cutting off rounds down.
[[gnu::always_inline]] inline std::int32_t fixed(float value, float most) {
  constexpr float kRound = kSubPixel + 0.5F;
  return static_cast<std::int32_t>(limited(value, -kSubPixel, most) + kRound) - kSubPixel;
}

void fill_row(const RowLines& lines, int count, float most_u, float most_v, std::int32_t* __restrict u,
              std::int32_t* __restrict v, std::uint16_t* __restrict gain) {
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<float>(i);
    const float inverse = 1.0F / (lines.w.first + at * lines.w.step);
    u[i] = fixed((lines.u.first + at * lines.u.step) * inverse, most_u);
    v[i] = fixed((lines.v.first + at * lines.v.step) * inverse, most_v);
    gain[i] = static_cast<std::uint16_t>(
        static_cast<std::int32_t>(limited(lines.gain.first + at * lines.gain.step + 0.5F, 1.0F, kFullGain)));
  }
}

/// One row between the cell's left and right edge, `down` of its height from the top.
class CellEdges {
 public:
  CellEdges(const WarpMap& map, int column, int row)
      : top_left_(map.node(column, row)),
        top_right_(map.node(column + 1, row)),
        bottom_left_(map.node(column, row + 1)),
        bottom_right_(map.node(column + 1, row + 1)),
        scale_(std::ldexp(static_cast<double>(kSubPixel), map.parts().exponent)),
        step_(1.0 / map.parts().cell_px) {}

  RowLines row(int j) const {
    const double down = j * step_;
    return {.u = line(&WarpNode::u, down, scale_),
            .v = line(&WarpNode::v, down, scale_),
            .w = line(&WarpNode::w, down, 1),
            .gain = line(&WarpNode::gain, down, 1)};
  }

 private:
  template <class Member>
  Line line(Member member, double down, double scale) const {
    const double left = (1 - down) * (top_left_.*member) + down * (bottom_left_.*member);
    const double right = (1 - down) * (top_right_.*member) + down * (bottom_right_.*member);
    return {.first = static_cast<float>(scale * left), .step = static_cast<float>(scale * (right - left) * step_)};
  }

  const WarpNode& top_left_;
  const WarpNode& top_right_;
  const WarpNode& bottom_left_;
  const WarpNode& bottom_right_;
  double scale_;
  double step_;
};

void fill_grid(const WarpMap& map, int column, int row, WarpTile& tile) {
  const CellEdges edges(map, column, row);
  const auto most_u = static_cast<float>(map.parts().content_width * kSubPixel);
  const auto most_v = static_cast<float>(map.parts().content_height * kSubPixel);
  for (int j = 0; j < tile.height; ++j) {
    const std::size_t at = WarpTile::at(0, j);
    fill_row(edges.row(j), tile.width, most_u, most_v, &tile.u[at], &tile.v[at], &tile.gain[at]);
  }
}

void apply_mask(const std::uint8_t* mask, int cell_px, WarpTile& tile) {
  for (int j = 0; j < tile.height; ++j) {
    const std::uint8_t* bits = mask + j * cell_px / 8;
    for (int i = 0; i < tile.width; ++i) {
      // All ones where the bit is set.
      const std::int32_t keep = -((bits[i / 8] >> (i % 8)) & 1);
      const std::size_t at = WarpTile::at(i, j);
      tile.u[at] &= keep;
      tile.v[at] &= keep;
      tile.gain[at] = static_cast<std::uint16_t>(tile.gain[at] & keep);
    }
  }
}

void copy_dense(const WarpSample* samples, int cell_px, WarpTile& tile) {
  for (int j = 0; j < tile.height; ++j) {
    for (int i = 0; i < tile.width; ++i) {
      const WarpSample& sample = samples[j * cell_px + i];
      const std::size_t at = WarpTile::at(i, j);
      tile.u[at] = sample.u;
      tile.v[at] = sample.v;
      tile.gain[at] = sample.gain;
    }
  }
}

}  // namespace

void evaluate(const WarpMap& map, int column, int row, WarpTile& tile) {
  const WarpMapParts& parts = map.parts();
  tile.x = column * parts.cell_px;
  tile.y = row * parts.cell_px;
  tile.width = std::min(parts.cell_px, parts.panel_width - tile.x);
  tile.height = std::min(parts.cell_px, parts.panel_height - tile.y);
  const CellKind kind = map.kind(column, row);
  tile.empty = kind == CellKind::kEmpty;
  if (kind == CellKind::kDense) {
    copy_dense(map.dense(column, row), parts.cell_px, tile);
  } else if (!tile.empty) {
    fill_grid(map, column, row, tile);
    if (kind == CellKind::kMasked) {
      apply_mask(map.mask(column, row), parts.cell_px, tile);
    }
  }
}

}  // namespace raysteer::proto::lut
