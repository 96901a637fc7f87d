#include "sim/scene/texture.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/seed.hpp"

namespace raysteer::sim::scene {
namespace {

const Chessboard kBoard{.columns = 5, .rows = 4, .square_m = 0.05, .ink = {.white = 0.8, .black = 0.1}};

TEST(ChessboardTexture, has_a_black_first_square_and_white_beyond_its_squares) {
  const Texture board(kBoard);
  EXPECT_DOUBLE_EQ(board.albedo({-0.01, -0.01}), 0.1);
  EXPECT_DOUBLE_EQ(board.albedo({0.01, -0.01}), 0.8);
  EXPECT_DOUBLE_EQ(board.albedo({0.01, 0.01}), 0.1);
  EXPECT_DOUBLE_EQ(board.albedo({-0.051, -0.01}), 0.8);
  EXPECT_DOUBLE_EQ(board.albedo({0.249, 0.199}), 0.8);  // last square: 5 + 4 is odd, so it is white
  EXPECT_DOUBLE_EQ(board.albedo({0.249, 0.149}), 0.1);
  EXPECT_DOUBLE_EQ(board.albedo({0.251, 0.149}), 0.8);
}

TEST(ChessboardTexture, mean_over_a_box_is_that_of_many_points) {
  std::mt19937_64 random(support::seed());
  std::uniform_real_distribution<double> place(-0.1, 0.3);
  std::uniform_real_distribution<double> side(0.001, 0.12);
  const Texture board(kBoard);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector2d uv(place(random), place(random));
    const Eigen::Vector2d size(side(random), side(random));
    double sum = 0;
    constexpr int kSamples = 100;
    for (int k = 0; k < kSamples * kSamples; ++k) {
      const Eigen::Vector2d share((k % kSamples + 0.5) / kSamples - 0.5, (k / kSamples + 0.5) / kSamples - 0.5);
      sum += board.albedo(uv + size.cwiseProduct(share));
    }
    // A border may fall between two samples: half of one row of each border crossed.
    EXPECT_NEAR(board.albedo(uv, size), sum / (kSamples * kSamples), 0.7 * 6 * 0.5 / kSamples);
  }
}

TEST(RingDatumTexture, shows_its_code_in_the_ring) {
  const RingDatum datum{.radius_m = 0.02, .code = 0b0110, .bits = 4, .ink = {.white = 0.9, .black = 0.1}};
  const Texture texture(datum);
  EXPECT_EQ(texture.albedo({0.0, 0.019}), 0.9);   // disc
  EXPECT_EQ(texture.albedo({0.0, 0.03}), 0.1);    // gap
  EXPECT_EQ(texture.albedo({0.03, 0.03}), 0.1);   // sector 0: +u towards +v
  EXPECT_EQ(texture.albedo({-0.03, 0.03}), 0.9);  // sector 1
  EXPECT_EQ(texture.albedo({-0.03, -0.03}), 0.9);
  EXPECT_EQ(texture.albedo({0.03, -0.03}), 0.1);
  EXPECT_EQ(texture.albedo({0.07, 0.0}), 0.1);  // beyond
}

TEST(PictureTexture, is_spread_by_its_pixel_size) {
  auto albedo = std::make_shared<Image<float>>(2, 1);
  (*albedo)(0, 0) = 0.25F;
  (*albedo)(1, 0) = 0.75F;
  const Texture texture(Picture{.albedo = albedo, .pixel_m = 0.1});
  EXPECT_EQ(texture.albedo({0.05, 0.05}), 0.25);
  EXPECT_EQ(texture.albedo({0.15, 0.05}), 0.75);
  EXPECT_EQ(texture.albedo({-5, 9}), 0.25);
  EXPECT_NEAR(texture.albedo({0.1, 0.05}, {0.1, 0.1}), 0.5, 1e-6);
}

}  // namespace
}  // namespace raysteer::sim::scene
