// Projector pixels are found where they are, with an honest covariance, and never across a depth edge.
#include "calib/scene/match.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "calib/synth/noise.hpp"

namespace raysteer::calib::scene {
namespace {

constexpr int kSize = 120;
constexpr double kPitch = 1.6;  // camera px per projector px

/// A camera looking straight at a wall: x = (u - 10) / pitch, y likewise with a shear.
struct Wall {
  double shift = 10;
  double pitch = kPitch;
  Eigen::Vector2d panel(double u, double v) const { return {(u - shift) / pitch, (v - 7 + 0.1 * (u - shift)) / pitch}; }
  Eigen::Vector2d camera(double i, double j) const {
    const double u = pitch * i + shift;
    return {u, pitch * j + 7 - 0.1 * (u - shift)};
  }
};

decode::CodeMap empty_map() {
  decode::CodeMap map;
  for (Image<float>* image : {&map.x, &map.y, &map.variance_x, &map.variance_y}) {
    *image = Image<float>(kSize, kSize);
  }
  map.mask = Image<std::uint8_t>(kSize, kSize);
  return map;
}

/// Pixels left of `edge_u` see one wall, the others another.
decode::CodeMap seen(const Wall& wall, const Wall& other, int edge_u, double sigma, std::uint64_t seed) {
  decode::CodeMap map = empty_map();
  synth::Noise noise(seed);
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      const Eigen::Vector2d x = (u < edge_u ? wall : other).panel(u, v);
      map.x(u, v) = static_cast<float>(x.x() + sigma * noise.normal());
      map.y(u, v) = static_cast<float>(x.y() + sigma * noise.normal());
      map.variance_x(u, v) = map.variance_y(u, v) = static_cast<float>(sigma * sigma);
      map.mask(u, v) = x.minCoeff() > -0.4 ? decode::kValid : decode::kOutside;
    }
  }
  return map;
}

TEST(Match, finds_projector_pixels_where_they_are) {
  const Wall wall;
  const auto sightings = locate(seen(wall, wall, kSize, 0, 1), 60, 60);
  ASSERT_TRUE(sightings);
  for (int j = 2; j < 58; ++j) {
    for (int i = 2; i < 58; ++i) {
      ASSERT_GT((*sightings)(i, j).pixels, 0);
      EXPECT_LT(((*sightings)(i, j).q.cast<double>() - wall.camera(i, j)).norm(), 1e-4);
    }
  }
}

TEST(Match, covariance_agrees_with_the_scatter_and_beats_single_pixels) {
  const Wall wall;
  const double sigma = 0.1;
  double squares = 0, normalised = 0;
  int n = 0;
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    const auto sightings = locate(seen(wall, wall, kSize, sigma, seed), 60, 60);
    ASSERT_TRUE(sightings);
    for (int j = 2; j < 58; ++j) {
      for (int i = 2; i < 58; ++i) {
        const Sighting& s = (*sightings)(i, j);
        const Eigen::Vector2d miss = s.q.cast<double>() - wall.camera(i, j);
        Eigen::Matrix2d c;
        c << s.cxx, s.cxy, s.cxy, s.cyy;
        squares += miss.squaredNorm() / 2;
        normalised += miss.dot(c.ldlt().solve(miss)) / 2;
        ++n;
      }
    }
  }
  EXPECT_LT(std::sqrt(squares / n), 0.75 * kPitch * sigma);
  EXPECT_GT(normalised / n, 0.6);
  EXPECT_LT(normalised / n, 1.5);
}

TEST(Match, does_not_mix_two_surfaces_at_a_depth_edge) {
  const Wall near{.shift = 10}, far{.shift = -6};  // the panel jumps by 10 px at the edge
  const auto sightings = locate(seen(near, far, 60, 0, 1), 90, 60);
  ASSERT_TRUE(sightings);
  int checked = 0;
  for (int i = 3; i < 75; ++i) {
    const Sighting& s = (*sightings)(i, 25);
    if (s.seen() && !s.interpolated()) {
      const Eigen::Vector2d q = s.q.cast<double>();
      EXPECT_LT(std::min((q - near.camera(i, 25)).norm(), (q - far.camera(i, 25)).norm()), 0.05) << i;
      ++checked;
    }
  }
  EXPECT_GT(checked, 55);
}

TEST(Match, counts_pixels_that_only_neighbours_would_add) {
  const Wall wall;
  decode::CodeMap map = seen(wall, wall, kSize, 0, 1);
  const decode::CodeMap whole = seen(wall, wall, kSize, 0, 1);
  for (int v = 0; v < kSize; ++v) {
    for (int u = 0; u < kSize; ++u) {
      if (std::lround(map.x(u, v)) == 30) {
        map.mask(u, v) = decode::kAmbiguous;
      }
    }
  }
  const Matches matches = match(*locate(map, 60, 60), *locate(whole, 60, 60));
  EXPECT_GT(matches.interpolated, 50U);
  EXPECT_LE(matches.interpolated, 60U);
  for (const Match& m : matches.measured) {
    EXPECT_NE(m.i, 30);
  }
}

// A rig's camera sees the whole room, its projector a part of it in finer pixels.
TEST(Match, finds_nodes_where_one_camera_pixel_covers_several_projector_pixels) {
  const Wall wall{.shift = 10, .pitch = 1 / 2.75};
  const double sigma = 0.05;
  const decode::CodeMap map = seen(wall, wall, kSize, sigma, 21);
  const int spacing = node_spacing(map, map);
  EXPECT_EQ(spacing, 4);
  const auto sightings = locate(map, 300, 300, spacing);
  ASSERT_TRUE(sightings);
  EXPECT_EQ(sightings->width(), 75);
  double squares = 0, normalised = 0;
  int n = 0;
  for (int j = 2; j < 70; ++j) {
    for (int i = 2; i < 70; ++i) {
      const Sighting& s = (*sightings)(i, j);
      ASSERT_GT(s.pixels, 0);
      const Eigen::Vector2d miss = s.q.cast<double>() - wall.camera(i * spacing, j * spacing);
      Eigen::Matrix2d c;
      c << s.cxx, s.cxy, s.cxy, s.cyy;
      squares += miss.squaredNorm() / 2;
      normalised += miss.dot(c.ldlt().solve(miss)) / 2;
      ++n;
    }
  }
  EXPECT_LT(std::sqrt(squares / n), 0.75 * wall.pitch * sigma);
  EXPECT_GT(normalised / n, 0.6);
  EXPECT_LT(normalised / n, 1.5);
  const Matches with_projector = match_projector(*sightings, spacing);
  for (const Match& m : with_projector.measured) {
    EXPECT_EQ(m.q_right, Eigen::Vector2d(spacing * m.i, spacing * m.j));
  }
}

TEST(Match, the_coarser_view_decides_how_far_nodes_are_apart) {
  const Wall fine{.shift = 10, .pitch = 1};
  const Wall coarse{.shift = 10, .pitch = 0.5};
  const decode::CodeMap close = seen(fine, fine, kSize, 0, 1);
  const decode::CodeMap wide = seen(coarse, coarse, kSize, 0, 1);
  EXPECT_EQ(node_spacing(close, close), 1);
  EXPECT_EQ(node_spacing(close, wide), 3);
  EXPECT_EQ(node_spacing(wide, close), 3);
}

TEST(Match, refuses_a_sequence_that_codes_one_axis) {
  decode::CodeMap map = empty_map();
  map.y = {};
  const auto sightings = locate(map, 60, 60);
  ASSERT_FALSE(sightings);
  EXPECT_EQ(sightings.error().rcode, RCode::kNothingDecoded);
}

}  // namespace
}  // namespace raysteer::calib::scene
