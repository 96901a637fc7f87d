#include "calib/synth/decode_trial.hpp"

#include <cmath>

namespace raysteer::calib::synth {
namespace {

constexpr double kGross = 1.5;

int bits_for(double codes) { return static_cast<int>(std::ceil(std::log2(codes))); }

PatternSequence with_references(int panel) {
  return {.panel_width = panel,
          .panel_height = panel,
          .blocks = {{.kind = PatternKind::kWhite}, {.kind = PatternKind::kBlack}}};
}

}  // namespace

PatternSequence gray_sequence(int panel, bool inverse) {
  PatternSequence sequence = with_references(panel);
  sequence.blocks.push_back({.kind = PatternKind::kGray, .bits = bits_for(panel), .inverse = inverse});
  return sequence;
}

PatternSequence gray_phase_sequence(int panel, bool inverse, int steps, double period_px) {
  PatternSequence sequence = with_references(panel);
  const double stripe = period_px / 2;
  sequence.blocks.push_back(
      {.kind = PatternKind::kGray, .bits = bits_for(panel / stripe + 1), .stripe_px = stripe, .inverse = inverse});
  sequence.blocks.push_back({.kind = PatternKind::kPhase, .steps = steps, .period_px = period_px});
  return sequence;
}

PatternSequence heterodyne_sequence(int panel, int steps, double first_period_px, double second_period_px) {
  PatternSequence sequence = with_references(panel);
  sequence.blocks.push_back({.kind = PatternKind::kPhase, .steps = steps, .period_px = first_period_px});
  sequence.blocks.push_back({.kind = PatternKind::kPhase, .steps = steps, .period_px = second_period_px});
  return sequence;
}

Result<DecodeTrial> decode_trial(const PatternSequence& sequence, const SeparableView& view,
                                 const decode::Options& options, std::uint64_t seed) {
  Result<decode::Decoder> decoder = decode::Decoder::make(sequence, view.width, view.height, view.bits, options);
  if (!decoder) {
    return std::move(decoder).error();
  }
  const SeparableCamera camera(view, sequence);
  Noise noise(seed);
  for (const Pattern& pattern : sequence.patterns()) {
    if (view.bits == 8) {
      RAYSTEER_TRY(decoder->push(camera.frame8(pattern, noise).view()));
    } else {
      RAYSTEER_TRY(decoder->push(camera.frame(pattern, noise).view()));
    }
  }
  Result<decode::CodeMap> map = decoder->finish();
  if (!map) {
    return std::move(map).error();
  }
  double pixels = 0, valid = 0, gross = 0, squares = 0, variances = 0, integer_squares = 0;
  for (int v = 0; v < view.height; ++v) {
    for (int u = 0; u < view.width; ++u) {
      const double truth = camera.x(u);
      if (truth < 0 || truth > sequence.panel_width - 1) {
        continue;
      }
      ++pixels;
      if (map->mask(u, v) != decode::kValid) {
        continue;
      }
      ++valid;
      const double error = map->x(u, v) - truth;
      if (std::abs(error) > kGross) {
        ++gross;
        continue;
      }
      squares += error * error;
      variances += map->variance_x(u, v);
      integer_squares += (map->code_x(u, v) - truth) * (map->code_x(u, v) - truth);
    }
  }
  double bends = 0, bend_squares = 0;
  for (int v = 0; v < view.height; ++v) {
    for (int u = 1; u + 1 < view.width; ++u) {
      const double bend = map->x(u, v) - 0.5 * (map->x(u - 1, v) + map->x(u + 1, v));
      if (std::abs(bend) < kGross) {
        ++bends;
        bend_squares += bend * bend / 1.5;
      }
    }
  }
  const double correct = valid - gross;
  return DecodeTrial{.rms_px = std::sqrt(squares / correct),
                     .predicted_px = std::sqrt(variances / correct),
                     .gross = gross / valid,
                     .valid = valid / pixels,
                     .integer_rms_px = std::sqrt(integer_squares / correct),
                     .order_residual = map->diagnostics.order_residual_x,
                     .border_displacement = map->diagnostics.border_displacement_x,
                     .scatter_px = std::sqrt(bend_squares / bends)};
}

}  // namespace raysteer::calib::synth
