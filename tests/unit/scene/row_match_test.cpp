// Rows of a rectified pair find their partners, and the noise stated is the noise put in.
#include "calib/scene/row_match.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/synth/noise.hpp"

namespace raysteer::calib::scene {
namespace {

constexpr int kWidth = 200, kHeight = 80;

/// Columns seen at u are 0.8 (u + shift), with noise of `sigma` px of the projector.
decode::CodeMap view(double shift, double sigma, std::uint64_t seed) {
  synth::Noise noise(seed);
  decode::CodeMap map;
  map.x = Image<float>(kWidth, kHeight);
  map.mask = Image<std::uint8_t>(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      map.x(u, v) = static_cast<float>(0.8 * (u + shift) + sigma * noise.normal());
      map.mask(u, v) = u % 50 == 0 ? decode::kShadow : decode::kValid;
    }
  }
  return map;
}

TEST(RowMatch, finds_the_disparity_of_each_pixel) {
  const auto rows = match_rows(view(12.3, 0, 1), view(20, 0, 2));
  ASSERT_TRUE(rows);
  std::size_t matched = 0;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      if (std::isfinite(rows->disparity(u, v))) {
        EXPECT_NEAR(static_cast<double>(rows->disparity(u, v)), 7.7, 1e-3);
        ++matched;
      }
    }
  }
  EXPECT_EQ(matched, rows->matched);
  EXPECT_GT(matched, 0.85 * kWidth * kHeight);
  EXPECT_LT(rows->p95_px, 1e-3);
}

TEST(RowMatch, states_the_noise_it_has) {
  // 0.05 px of the projector are 0.0625 px of a camera; the left pixel's and the interpolated right one's add up.
  const auto rows = match_rows(view(12.3, 0.05, 3), view(20, 0.05, 4));
  ASSERT_TRUE(rows);
  const double least = 0.0625 * std::sqrt(1 + 0.5);
  const double most = 0.0625 * std::sqrt(2.0);
  EXPECT_GT(rows->sigma_px, 0.95 * least);
  EXPECT_LT(rows->sigma_px, 1.05 * most);
  EXPECT_NEAR(rows->p95_px / rows->sigma_px, 1.96, 0.1);
  EXPECT_GT(rows->row_p95_worst_px, rows->row_p95_median_px);
  EXPECT_EQ(rows->rows, static_cast<std::size_t>(kHeight - 2));
}

TEST(RowMatch, refuses_views_that_share_nothing) {
  const auto rows = match_rows(view(0, 0, 1), view(5000, 0, 2));
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().rcode, RCode::kTooFewMatches);
}

TEST(RowMatch, refuses_a_sequence_without_columns) {
  decode::CodeMap none = view(0, 0, 1);
  none.x = {};
  const auto rows = match_rows(none, view(0, 0, 2));
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().rcode, RCode::kNothingDecoded);
}

}  // namespace
}  // namespace raysteer::calib::scene
