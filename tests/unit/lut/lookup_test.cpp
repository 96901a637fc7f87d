#include <gtest/gtest.h>

#include <limits>

#include "proto/lut/evaluate.hpp"
#include "tests/support/seed.hpp"
#include "tests/unit/lut/small_set.hpp"

namespace raysteer::proto::lut {
namespace {

/// In fixed point a coordinate is off by half a step, and by what its nodes and single precision round.
constexpr double kRounding = 0.5 / kSubPixel + 5e-4;

TEST(WarpMap, evaluates_planes_to_the_rounding_of_fixed_point_in_cells_of_any_size) {
  std::mt19937_64 random(support::seed());
  for (const int cell : {8, 16, 32, 64}) {
    constexpr int kWidth = 333;  // not a multiple of the cell
    constexpr int kHeight = 201;
    const Homography h = random_homography(random, kWidth, kHeight);
    const WarpMap map = valid(WarpMap::make(projective_parts(h, kWidth, kHeight, cell)));
    WarpTile tile;
    int pixels = 0;
    for (int row = 0; row < map.rows(); ++row) {
      for (int column = 0; column < map.columns(); ++column) {
        evaluate(map, column, row, tile);
        ASSERT_FALSE(tile.empty);
        for (int j = 0; j < tile.height; ++j) {
          for (int i = 0; i < tile.width; ++i, ++pixels) {
            const std::size_t at = WarpTile::at(i, j);
            const int x = tile.x + i;
            const int y = tile.y + j;
            ASSERT_NEAR(tile.u[at] / double{kSubPixel}, h.u_at(x, y), kRounding) << x << ", " << y;
            ASSERT_NEAR(tile.v[at] / double{kSubPixel}, h.v_at(x, y), kRounding) << x << ", " << y;
            ASSERT_NEAR(tile.gain[at], 32000 - 10 * x, 0.51);
          }
        }
      }
    }
    EXPECT_EQ(pixels, kWidth * kHeight);
  }
}

TEST(WarpMap, shows_nothing_where_its_bits_are_not_set_and_dense_pixels_as_stored) {
  const LutSet set = small_set();
  const WarpMap& map = set.maps[0];
  WarpTile tile;
  evaluate(map, 2, 0, tile);
  EXPECT_TRUE(tile.empty);
  evaluate(map, 1, 0, tile);
  EXPECT_EQ(tile.x, 8);
  for (int j = 0; j < 8; ++j) {
    for (int i = 0; i < 8; ++i) {
      const bool shown = (map.mask(1, 0)[j] >> i) & 1;
      EXPECT_EQ(tile.gain[WarpTile::at(i, j)] != 0, shown) << i << ", " << j;
      EXPECT_EQ(tile.u[WarpTile::at(i, j)] != 0, shown);
    }
  }
  evaluate(map, 0, 1, tile);
  EXPECT_EQ(tile.height, 4);
  for (int j = 0; j < tile.height; ++j) {
    for (int i = 0; i < tile.width; ++i) {
      const int k = 8 * j + i;
      EXPECT_EQ(tile.u[WarpTile::at(i, j)], k % 9 == 0 ? 0 : 100 * k);
      EXPECT_EQ(tile.gain[WarpTile::at(i, j)], k % 9 == 0 ? 0 : 5000);
    }
  }
}

TEST(WarpMap, is_not_made_of_parts_that_do_not_fit) {
  const WarpMapParts good = small_set().maps[0].parts();
  const auto refused = [&](const auto& change) {
    WarpMapParts parts = good;
    change(parts);
    const auto map = WarpMap::make(std::move(parts));
    return !map && map.error().rcode == RCode::kTableDamaged;
  };
  EXPECT_FALSE(refused([](WarpMapParts&) {}));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.name.clear(); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.name.assign(65, 'x'); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.panel_width = 40; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.content_width = 0; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.cell_px = 12; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.nodes.pop_back(); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.nodes[0].w = 0; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.masks.pop_back(); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.dense.pop_back(); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.dense[5].u = 1921 * kSubPixel; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.cells[2] = CellKind::kDense; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.cells[2] = static_cast<CellKind>(4); }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.worst_px = 0.06; }));
  EXPECT_TRUE(refused([](WarpMapParts& p) { p.bound_px = std::numeric_limits<double>::quiet_NaN(); }));
}

TEST(SteeringTable, is_bilinear_between_nodes_and_silent_where_no_light_comes) {
  const SteeringTable table = valid(SteeringTable::make(small_steering_parts()));
  const auto command = table.command({-0.35, 0.1});
  ASSERT_TRUE(command);
  EXPECT_NEAR(command->axis1_rad, 0.2 * 0.65 - 0.15, 1e-12);
  EXPECT_NEAR(command->axis2_rad, 0.24 * 0.6 - 0.12, 1e-12);
  EXPECT_TRUE(table.command({-1, -0.01}));
  EXPECT_FALSE(table.command({-1.0001, -0.01}));
  EXPECT_FALSE(table.command({-0.8, 0.2})) << "a cell that is not reached";
  EXPECT_FALSE(table.command({-1, -0.5})) << "axis 2 beyond its range";
  EXPECT_FALSE(table.command({std::numeric_limits<double>::quiet_NaN(), 0}));
  EXPECT_FALSE(table.command({0, std::numeric_limits<double>::infinity()}));
}

TEST(LutSet, aims_at_no_place_in_a_zone) {
  const LutSet set = small_set();
  EXPECT_TRUE(set.steering.command({0.2, 0.2}));
  EXPECT_FALSE(set.aim({0.2, 0.2}));
  EXPECT_TRUE(set.aim({-0.2, 0.2}));
  EXPECT_NE(set.find("second"), nullptr);
  EXPECT_EQ(set.find("third"), nullptr);
}

TEST(KeepOut, contains_what_lies_within_an_outline_with_a_notch) {
  const KeepOut zone = small_set().keep_out[0];
  EXPECT_TRUE(zone.contains({0.5, 0.2}));
  EXPECT_TRUE(zone.contains({0.1, 0.7}));
  EXPECT_FALSE(zone.contains({0.5, 0.7})) << "the notch";
  EXPECT_FALSE(zone.contains({-0.1, 0.5}));
  EXPECT_FALSE(zone.contains({0.5, -0.1}));
}

}  // namespace
}  // namespace raysteer::proto::lut
