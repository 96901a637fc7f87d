// Mixed pixels at depth edges are told from those of a surface by how coordinates go on around them.
#include "calib/decode/depth_edges.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "calib/decode/code_map.hpp"
#include "calib/synth/noise.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 47;
constexpr float kSigma = 0.03F;
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// A view whose coordinate at (u, v) is what `place` says, plus noise.
struct View {
  Image<float> value{kWidth, kHeight};
  Image<float> variance{kWidth, kHeight};
  Image<std::uint8_t> mask{kWidth, kHeight};

  explicit View(const std::function<double(int, int)>& place, float sigma = kSigma) {
    synth::Noise noise(support::seed(), 0xed6e);
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        value(u, v) = static_cast<float>(place(u, v) + sigma * noise.normal());
        variance(u, v) = sigma * sigma;
        mask(u, v) = std::isfinite(value(u, v)) ? kValid : kShadow;
      }
    }
  }
  void mark() {
    const Placed axis{&value, &variance};
    mark_depth_edges({&axis, 1}, mask);
  }
  int edges() const {
    int count = 0;
    for (int v = 0; v < kHeight; ++v) {
      for (int u = 0; u < kWidth; ++u) {
        count += mask(u, v) == kEdge ? 1 : 0;
      }
    }
    return count;
  }
};

double wall(int u, int v) { return 20 + 0.9 * u + 0.2 * v; }

TEST(DepthEdges, a_tilted_wall_has_none_up_to_its_corners) {
  View view(wall);
  view.mark();
  EXPECT_EQ(view.edges(), 0);
}

TEST(DepthEdges, a_round_surface_has_none) {
  // A ball of 300 px radius: bends by 1/300 px a pixel squared at its top, by 0.05 near this view's corners.
  View view([](int u, int v) { return 2 * std::sqrt(300.0 * 300.0 - u * u - v * v); });
  view.mark();
  EXPECT_EQ(view.edges(), 0);
}

TEST(DepthEdges, noise_that_is_known_is_no_edge) {
  View view(wall, 0.4F);
  view.mark();
  // Two sigma in each of three adjacent directions, anywhere around: next to all pixels have that.
  EXPECT_LT(view.edges(), kWidth * kHeight / 50);
}

TEST(DepthEdges, the_mixed_column_between_two_surfaces_is_one_and_its_neighbours_are_not) {
  constexpr int kEdgeColumn = 30;
  View view([](int u, int v) {
    const double mixture = u < kEdgeColumn ? 0 : u == kEdgeColumn ? 0.4 : 1;
    return wall(u, v) + 5 * mixture;
  });
  view.mark();
  for (int v = 0; v < kHeight; ++v) {
    EXPECT_EQ(view.mask(kEdgeColumn, v), kEdge) << "row " << v;
  }
  EXPECT_EQ(view.edges(), kHeight);
}

TEST(DepthEdges, a_sharp_step_keeps_both_sides_and_a_corner_of_90_degrees) {
  View view([](int u, int v) { return wall(u, v) + (u >= 30 && v >= 20 ? 6 : 0); });
  view.mark();
  EXPECT_EQ(view.edges(), 0);
}

TEST(DepthEdges, a_pixel_alone_in_shadow_is_one_and_shadow_stays_shadow) {
  View view([](int u, int v) { return u < 20 || (u == 40 && v == 20) ? wall(u, v) : kNan; });
  view.mark();
  EXPECT_EQ(view.edges(), 1);
  EXPECT_EQ(view.mask(40, 20), kEdge);
  EXPECT_EQ(view.mask(39, 20), kShadow);
}

TEST(DepthEdges, what_bends_in_one_axis_only_is_one) {
  View x(wall);
  View y([](int u, int v) { return wall(v, u) + (u == 30 ? 3 : 0); });
  const Placed axes[] = {{&x.value, &x.variance}, {&y.value, &y.variance}};
  mark_depth_edges(axes, x.mask);
  EXPECT_EQ(x.edges(), kHeight);
}

TEST(DepthEdges, images_smaller_than_a_bend_are_all_edge) {
  Image<float> value(2, 2), variance(2, 2);
  Image<std::uint8_t> mask(2, 2);
  const Placed axis{&value, &variance};
  mark_depth_edges({&axis, 1}, mask);
  EXPECT_EQ(mask(1, 1), kEdge);
}

}  // namespace
}  // namespace raysteer::calib::decode
