#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "hal/base/nearest.hpp"
#include "proto/plan/plan.hpp"

namespace raysteer::proto::plan {
namespace {

constexpr std::array<std::string_view, 4> kNames{"default", "fast", "best", "gray"};
constexpr double kPeriod = 16;         // of the phase, px (algorithms 2.3)
constexpr double kCheckPeriod = 17.3;  // of the second phase of "best"

PatternBlock gray(Axis axis, int length, double stripe_px, bool inverse) {
  const double stripes = std::ceil(length / stripe_px);
  const int bits = std::max(1, static_cast<int>(std::ceil(std::log2(stripes))));
  return {.kind = PatternKind::kGray, .axis = axis, .bits = bits, .stripe_px = stripe_px, .inverse = inverse};
}

// Periods begin at the panel's edge, as the Gray stripes do.
PatternBlock phase(Axis axis, int steps, double period_px) {
  return {.kind = PatternKind::kPhase, .axis = axis, .steps = steps, .period_px = period_px, .origin_px = -0.5};
}

}  // namespace

Result<PatternSequence> pattern_set(std::string_view name, int panel_width, int panel_height) {
  if (std::ranges::find(kNames, name) == kNames.end()) {
    return fail(RCode::kBadValue, "pattern set '" + std::string(name) + "'" + did_you_mean(name, kNames) +
                                      " Known: default fast best gray");
  }
  PatternSequence sequence{.panel_width = panel_width, .panel_height = panel_height, .blocks = {}};
  sequence.blocks.push_back({.kind = PatternKind::kWhite});
  sequence.blocks.push_back({.kind = PatternKind::kBlack});
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    const int length = axis == Axis::kX ? panel_width : panel_height;
    if (name == "gray") {
      sequence.blocks.push_back(gray(axis, length, 1, true));
      continue;
    }
    sequence.blocks.push_back(gray(axis, length, kPeriod / 2, name != "fast"));
    sequence.blocks.push_back(phase(axis, name == "fast" ? 4 : 8, kPeriod));
    if (name == "best") {
      sequence.blocks.push_back(phase(axis, 8, kCheckPeriod));
    }
  }
  sequence.blocks.push_back({.kind = PatternKind::kBlack});  // is the room still as bright?
  RAYSTEER_TRY(check(sequence));
  return sequence;
}

}  // namespace raysteer::proto::plan
