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
  Eigen::Vector2d panel(double u, double v) const {
    return {(u - shift) / kPitch, (v - 7 + 0.1 * (u - shift)) / kPitch};
  }
  Eigen::Vector2d camera(double i, double j) const {
    const double u = kPitch * i + shift;
    return {u, kPitch * j + 7 - 0.1 * (u - shift)};
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

TEST(Match, refuses_a_sequence_that_codes_one_axis) {
  decode::CodeMap map = empty_map();
  map.y = {};
  const auto sightings = locate(map, 60, 60);
  ASSERT_FALSE(sightings);
  EXPECT_EQ(sightings.error().rcode, RCode::kNothingDecoded);
}

}  // namespace
}  // namespace raysteer::calib::scene
