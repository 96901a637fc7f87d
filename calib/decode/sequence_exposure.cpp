// Is there light, and not too much of it? In all frames and in each.
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// A set with less of the view lit than this is taken for one that the projector does not reach.
constexpr double kLeastLit = 0.004;
// A frame with less of the lit places bright shows no light.
constexpr double kDark = 0.02;
// Stripes too fine for the camera come out as half of the range; this is well below.
constexpr float kGrey = 0.25F;

bool striped(double bright_share) { return bright_share > 1 - kNearlyAll && bright_share < kNearlyAll; }

// Gray frames that are dark though they must show light: where the inverse is not bright either; and, since a bit
// reads 1 at the edges of the next coarser one, where that one shows edges (it does too when it lost its own light).
void find_dark_bits(const SampledSet& set, const GrayBlock& gray, std::vector<int>& dark) {
  bool coarser_striped = false;
  for (auto bit = gray.bits.rbegin(); bit != gray.bits.rend(); ++bit) {
    const double bright = set.bright_share(bit->pattern);
    if (bit->inverse >= 0) {
      const double inverse = set.bright_share(bit->inverse);
      if (bright < kDark && inverse < kNearlyAll) {
        dark.push_back(bit->pattern);
      }
      if (inverse < kDark && bright < kNearlyAll) {
        dark.push_back(bit->inverse);
      }
    } else if (coarser_striped && set.bright_share(bit->pattern, kGrey) < kDark) {
      dark.push_back(bit->pattern);
    } else {
      coarser_striped = striped(bright);
    }
  }
}

}  // namespace

bool judge_light(const SampledSet& set, Findings& findings) {
  findings.report.brightest = percentile(set.high, 0.99);
  std::size_t always_saturated = 0;
  std::size_t sometimes = 0;
  for (std::size_t i = 0; i < set.count(); ++i) {
    always_saturated += set.low[i] >= kSaturatedLevel ? 1 : 0;
  }
  findings.report.lit = static_cast<double>(set.lit.size()) / static_cast<double>(set.count());
  if (findings.report.brightest < kLitLevels) {
    findings.fault(RCode::kFramesBlack,
                   "the brightest of all frames reaches " + fixed(findings.report.brightest) + " of 255 levels");
    return false;
  }
  const double saturated = static_cast<double>(always_saturated) / static_cast<double>(set.count());
  if (saturated > 0.5) {
    findings.fault(RCode::kFramesSaturated, percent(saturated) + " of the view is saturated in every frame");
    return false;
  }
  if (set.gray.empty() && set.phase.empty()) {
    return false;
  }
  if (findings.report.lit < kLeastLit) {
    findings.fault(RCode::kFramesBlack, "the projector's patterns are not seen: only " + percent(findings.report.lit) +
                                            " of the view changes by more than " + fixed(kLitLevels) + " levels");
    return false;
  }
  std::vector<float> contrasts;
  for (const std::size_t i : set.lit) {
    contrasts.push_back(set.range(i));
    const float brightest = set.white.empty() ? set.high[i] : set.at(set.white.front(), i);
    sometimes += brightest >= kSaturatedLevel ? 1 : 0;
  }
  findings.report.contrast = percentile(contrasts, 0.5);
  findings.report.saturated = static_cast<double>(sometimes) / static_cast<double>(set.lit.size());
  const std::string note = percent(findings.report.saturated) + " of the lit view saturates in the brightest frame";
  // Binary stripes survive saturation as long as dark stays dark; a sinusoid does not.
  if (findings.report.saturated > 0.5 && !set.phase.empty()) {
    findings.fault(RCode::kFramesSaturated, note + "; a phase cannot be read there");
  } else if (findings.report.saturated > 0.2) {
    findings.warn(RCode::kFramesSaturated, note);
  }
  return true;
}

void judge_single_frames(const SampledSet& set, Findings& findings) {
  std::vector<int> dark;
  std::vector<int> clipped;
  const std::size_t stride = std::max<std::size_t>(1, set.count() / 20000);
  for (int k = 0; k < set.frames(); ++k) {
    const PatternKind kind = set.kind(k);
    std::size_t full = 0;
    std::size_t looked = 0;
    for (std::size_t i = 0; i < set.count(); i += stride, ++looked) {
      full += set.at(k, i) >= kSaturatedLevel ? 1 : 0;
    }
    // Dark places between the stripes, and those the projector does not reach, keep a sound frame below this.
    if (static_cast<double>(full) > 0.95 * static_cast<double>(looked)) {
      clipped.push_back(k);
      continue;
    }
    const double bright = set.bright_share(k);
    if ((kind == PatternKind::kWhite && bright < 1 - kNearlyAll) || (kind == PatternKind::kPhase && bright < kDark)) {
      dark.push_back(k);
    }
  }
  for (const GrayBlock& gray : set.gray) {
    find_dark_bits(set, gray, dark);
  }
  std::ranges::sort(dark);
  if (!clipped.empty()) {
    findings.fault(RCode::kFramesSaturated, list_of(clipped) + " saturate all over the view", clipped.front());
  }
  if (!dark.empty()) {
    findings.fault(RCode::kFramesBlack,
                   list_of(dark) + (dark.size() == 1 ? " shows" : " show") + " no light of the projector",
                   dark.front());
  }
  findings.dispute(clipped);
  findings.dispute(dark);
}

}  // namespace raysteer::calib::decode
