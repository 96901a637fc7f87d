#include <gtest/gtest.h>

#include <algorithm>

#include "proto/lut/evaluate.hpp"
#include "proto/lut/sections.hpp"
#include "tests/unit/lut/small_set.hpp"

namespace raysteer::proto::lut {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(LutBytes, come_back_as_the_same_set_and_the_same_bytes) {
  const LutSet set = small_set();
  const Bytes bytes = valid(write_lut_set(set));
  const LutSet again = valid(read_lut_set(bytes));
  EXPECT_EQ(again, set);
  EXPECT_EQ(valid(write_lut_set(again)), bytes);
}

TEST(LutBytes, are_these_on_every_machine) {
  // Bytes already out there must stay readable: a change here needs a new format version.
  const Bytes bytes = valid(write_lut_set(small_set()));
  EXPECT_EQ(bytes.size(), 2511U);
  EXPECT_EQ(object_id(bytes), "2d4c0521b719ceedd16dc9fa8f6b1fede41a55687e5f43e096186b2ba860bca7");
}

TEST(LutBytes, with_any_byte_changed_are_refused) {
  const Bytes bytes = valid(write_lut_set(small_set()));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const std::uint8_t change : std::to_array<std::uint8_t>({0x01, 0x80, 0xff})) {
      Bytes damaged = bytes;
      damaged[i] ^= change;
      const auto read = read_lut_set(damaged);
      ASSERT_FALSE(read) << "byte " << i;
      EXPECT_TRUE(read.error().rcode == RCode::kTableDamaged || read.error().rcode == RCode::kTableVersion);
    }
  }
}

TEST(LutBytes, cut_off_anywhere_or_with_more_behind_are_refused) {
  Bytes bytes = valid(write_lut_set(small_set()));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto read = read_lut_set(std::span(bytes).first(size));
    ASSERT_FALSE(read) << size << " bytes";
    EXPECT_EQ(read.error().rcode, RCode::kTableDamaged);
  }
  bytes.push_back(0);
  EXPECT_EQ(read_lut_set(bytes).error().rcode, RCode::kTableDamaged);
}

TEST(LutBytes, of_a_newer_format_are_named_so) {
  Bytes bytes = valid(write_lut_set(small_set()));
  bytes[4] = kLutVersion + 1;
  const auto read = read_lut_set(bytes);
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().rcode, RCode::kTableVersion);
}

/// Behind a right hash anything may come: it is refused, or harmless.
template <class Read, class Use>
void damage_each_byte(const Bytes& bytes, const Read& read, const Use& use) {
  ASSERT_TRUE(read(bytes));
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const std::uint8_t value : std::to_array<std::uint8_t>({0x00, 0x01, 0x7f, 0x80, 0xff})) {
      Bytes damaged = bytes;
      damaged[i] = value;
      if (const auto section = read(damaged)) {
        use(*section);
      }
    }
    EXPECT_FALSE(read(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(i))));
  }
}

TEST(LutSection, of_a_warp_map_never_gives_coordinates_off_the_content) {
  WarpTile tile;
  damage_each_byte(write_warp_map(small_set().maps[0]), read_warp_map, [&](const WarpMap& map) {
    for (int row = 0; row < map.rows(); ++row) {
      for (int column = 0; column < map.columns(); ++column) {
        evaluate(map, column, row, tile);
        for (int j = 0; j < tile.height && !tile.empty; ++j) {
          for (int i = 0; i < tile.width; ++i) {
            const std::size_t at = WarpTile::at(i, j);
            ASSERT_GE(tile.u[at], -kSubPixel);
            ASSERT_GE(tile.v[at], -kSubPixel);
            ASSERT_LE(tile.u[at], map.parts().content_width * kSubPixel);
            ASSERT_LE(tile.v[at], map.parts().content_height * kSubPixel);
          }
        }
      }
    }
  });
}

TEST(LutSection, of_the_steering_table_never_commands_beyond_its_range) {
  damage_each_byte(write_steering(small_set().steering), read_steering, [](const SteeringTable& table) {
    for (double x = -3; x < 3; x += 0.37) {
      for (double y = -3; y < 3; y += 0.37) {
        if (const auto command = table.command({x, y})) {
          ASSERT_LE(command->axis1_rad, 1e-9 * table.parts().most_nrad[0]);
          ASSERT_GE(command->axis2_rad, 1e-9 * table.parts().least_nrad[1]);
        }
      }
    }
  });
}

TEST(LutSection, of_zones_and_ids_survives_damage) {
  const LutSet set = small_set();
  damage_each_byte(write_keep_out(set.keep_out), read_keep_out, [](const std::vector<KeepOut>& zones) {
    (void)(!zones.empty() && zones[0].contains({0.5, 0.5}));
  });
  damage_each_byte(write_identity({.calibration_id = "a", .board_id = "b"}), read_identity, [](const Identity&) {});
}

TEST(LutSet, with_two_maps_of_one_name_is_not_written) {
  LutSet set = small_set();
  set.maps[1] = set.maps[0];
  EXPECT_EQ(write_lut_set(set).error().rcode, RCode::kTableDamaged);
}

}  // namespace
}  // namespace raysteer::proto::lut
