// Decoding of the real captures against what plain thresholds reach. Bounds have two sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/decoder.hpp"
#include "host/session/session.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::host::session {
namespace {

using calib::decode::CodeMap;
using calib::decode::Decoder;
using calib::decode::kValid;
using calib::decode::Options;

class DecodedCaptures : public testing::Test {
 protected:
  void SetUp() override {
    if (!support::captures()) {
      GTEST_SKIP() << "the real captures are not here (RAYSTEER_DATA_DIR)";
    }
  }

  static CodeMap decoded(const std::string& name, int camera, int look, const Options& options = {}) {
    Result<Session> session =
        Session::open(support::source_root() / "tests/data/sessions" / (name + ".toml"), support::captures());
    EXPECT_TRUE(session) << session.error().message();
    Result<Decoder> decoder =
        Decoder::make(session->manifest().sequence, session->width(camera), session->height(camera), 8, options);
    EXPECT_TRUE(decoder) << decoder.error().message();
    Image<std::uint8_t> frame;
    for (int index = 0; index < session->frames_per_look(); ++index) {
      EXPECT_TRUE(session->load({.camera = camera, .look = look, .index = index}, frame));
      EXPECT_TRUE(decoder->push(frame.view()));
    }
    Result<CodeMap> map = decoder->finish();
    EXPECT_TRUE(map) << map.error().message();
    return *std::move(map);
  }

  static double share(std::size_t part, std::size_t of) { return static_cast<double>(part) / static_cast<double>(of); }
};

/// Median departure of the middle of five valid pixels in a row, or column, from the parabola through the other four,
/// scaled to what it is of one pixel: noise without the surface's slope and curvature.
double scatter(const CodeMap& map, bool along_x) {
  const Image<float>& value = along_x ? map.x : map.y;
  std::vector<double> departures;
  for (int v = 2; v + 2 < value.height(); v += 3) {
    for (int u = 2; u + 2 < value.width(); u += 3) {
      const auto at = [&](int k) { return static_cast<double>(along_x ? value(u + k, v) : value(u, v + k)); };
      // Fourth difference: weights 1 -4 6 -4 1, variance 70.
      const double fourth = at(-2) - 4 * at(-1) + 6 * at(0) - 4 * at(1) + at(2);
      if (std::isfinite(fourth)) {
        departures.push_back(std::abs(fourth) / std::sqrt(70.0));
      }
    }
  }
  EXPECT_GT(departures.size(), 1000U);
  const auto middle = departures.begin() + static_cast<std::ptrdiff_t>(departures.size() / 2);
  std::nth_element(departures.begin(), middle, departures.end());
  return 1.4826 * *middle;
}

TEST_F(DecodedCaptures, bag_keeps_more_pixels_than_plain_thresholds) {
  for (const auto& [camera, plain] : {std::pair{0, 0.47}, std::pair{1, 0.46}}) {
    const CodeMap map = decoded("stereo-bag-scan", camera, 0);
    const double valid = share(map.diagnostics.valid, map.diagnostics.pixels);
    EXPECT_GT(valid, plain + 0.06);
    EXPECT_LT(valid, plain + 0.12);
    // The projector shows 1920 x 1080 on 1280 x 720: of three borders two coincide.
    EXPECT_NEAR(map.diagnostics.border_displacement_x, 0.34, 0.06);
    EXPECT_NEAR(map.diagnostics.border_displacement_y, 0.43, 0.06);
    const double x = scatter(map, true);
    const double y = scatter(map, false);
    std::printf("camera %d: valid %.4f, scatter x %.3f y %.3f px\n", camera, valid, x, y);
    EXPECT_LT(x, 0.15);
    EXPECT_LT(y, 0.15);
    EXPECT_GT(x, 0.01);
  }
}

TEST_F(DecodedCaptures, chessboard_pixels_scatter_by_hundredths) {
  const CodeMap map = decoded("procam-chessboard", 0, 0);
  EXPECT_LT(map.diagnostics.border_displacement_x, 0.1) << "this projector shows every column";
  const double valid = share(map.diagnostics.valid, map.diagnostics.pixels);
  const double x = scatter(map, true);
  const double y = scatter(map, false);
  std::printf("valid %.4f, scatter x %.3f y %.3f px\n", valid, x, y);
  EXPECT_NEAR(valid, 0.695, 0.03) << "plain thresholds: 0.567";
  EXPECT_LT(x, 0.04);
  EXPECT_LT(y, 0.04);
}

TEST_F(DecodedCaptures, angel_keeps_order_and_coverage_at_the_same_gates) {
  for (int camera = 0; camera < 2; ++camera) {
    const CodeMap gated = decoded("phaseshift-angel", camera, 0, {.min_modulation_dn = 8});
    EXPECT_LE(gated.diagnostics.order_residual_x, 0.056);
    EXPECT_GT(gated.diagnostics.order_residual_x, 0.050);
    EXPECT_GE(gated.diagnostics.coverage, 0.087);
    EXPECT_LT(gated.diagnostics.coverage, 0.089);
    const CodeMap ours = decoded("phaseshift-angel", camera, 0);
    std::printf("camera %d: order %.4f, coverage %.4f; own gates: coverage %.4f, valid %.4f\n", camera,
                gated.diagnostics.order_residual_x, gated.diagnostics.coverage, ours.diagnostics.coverage,
                share(ours.diagnostics.valid, ours.diagnostics.pixels));
    EXPECT_GT(ours.diagnostics.coverage, gated.diagnostics.coverage);
    EXPECT_GT(ours.diagnostics.valid, gated.diagnostics.valid);
  }
}

}  // namespace
}  // namespace raysteer::host::session
