// Where the projector's light is in a camera's image.
#include "calib/decode/lit_region.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>

#include "hal/base/image.hpp"

namespace raysteer::calib::decode {
namespace {

template <class Pixel>
struct Pair {
  Image<Pixel> white{400, 300};
  Image<Pixel> black{400, 300};

  Region lit() const { return lit_region(white.view(), black.view()); }
};

template <class Pixel>
Pair<Pixel> room(int ambient, int left, int top, int right, int bottom, int light) {
  Pair<Pixel> pair;
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 400; ++x) {
      const int noise = (x * 7 + y * 13) % 5;
      const bool inside = x >= left && x < right && y >= top && y < bottom;
      pair.black(x, y) = static_cast<Pixel>(ambient + noise);
      pair.white(x, y) = static_cast<Pixel>(ambient + (inside ? light : 0) + 4 - noise);
    }
  }
  return pair;
}

TEST(LitRegion, holds_the_picture_and_little_else) {
  const Region lit = room<std::uint8_t>(40, 100, 60, 300, 180, 120).lit();
  EXPECT_NEAR(lit.x, 100, 8);
  EXPECT_NEAR(lit.y, 60, 8);
  EXPECT_NEAR(lit.x + lit.width, 300, 12);
  EXPECT_NEAR(lit.y + lit.height, 180, 12);
}

TEST(LitRegion, does_not_depend_on_the_depth_of_the_pixels) {
  EXPECT_EQ(room<std::uint16_t>(40, 100, 60, 300, 180, 120).lit(),
            room<std::uint8_t>(40, 100, 60, 300, 180, 120).lit());
}

TEST(LitRegion, a_stray_reflection_does_not_widen_it) {
  Pair<std::uint8_t> pair = room<std::uint8_t>(40, 100, 60, 300, 180, 120);
  pair.white(392, 288) = 255;
  EXPECT_LT(pair.lit().x + pair.lit().width, 320);
}

TEST(LitRegion, is_everything_where_next_to_nothing_is_lit) {
  EXPECT_EQ(room<std::uint8_t>(40, 0, 0, 0, 0, 0).lit(), (Region{0, 0, 400, 300}));
  EXPECT_EQ(room<std::uint8_t>(40, 200, 200, 216, 216, 100).lit(), (Region{0, 0, 400, 300}));
}

TEST(LitRegion, reaches_the_borders_of_a_view_that_is_lit_all_over) {
  EXPECT_EQ(room<std::uint8_t>(40, 0, 0, 400, 300, 120).lit(), (Region{0, 0, 400, 300}));
}

}  // namespace
}  // namespace raysteer::calib::decode
