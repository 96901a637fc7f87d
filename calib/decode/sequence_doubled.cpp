// Are two frames alike that must differ?
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numbers>
#include <string>
#include <vector>

#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// Two frames are "the same" when they differ by less than this part of the contrast; exchanged stripes give 0.3 and
// more.
constexpr double kSame = 0.08;

// Mean difference of two frames over the lit places, as a part of the contrast.
double difference(const SampledSet& set, int a, int b) {
  const std::size_t stride = std::max<std::size_t>(1, set.lit.size() / 6000);
  double sum = 0;
  double range = 0;
  for (std::size_t n = 0; n < set.lit.size(); n += stride) {
    const std::size_t i = set.lit[n];
    sum += std::abs(set.at(a, i) - set.at(b, i));
    range += set.range(i);
  }
  return sum / range;
}

// How far a frame's places lie from the middle of their range, on average; 1 is fully bright or dark.
double own_contrast(const SampledSet& set, int frame) {
  const std::size_t stride = std::max<std::size_t>(1, set.lit.size() / 6000);
  double sum = 0;
  double range = 0;
  for (std::size_t n = 0; n < set.lit.size(); n += stride) {
    const std::size_t i = set.lit[n];
    sum += std::abs(2 * set.at(frame, i) - set.low[i] - set.high[i]);
    range += set.range(i);
  }
  return sum / range;
}

// Only frames that show stripes: those of which all edges are out of view may rightly be alike.
std::vector<int> striped_frames(const SampledSet& set, const Findings& findings) {
  std::vector<int> striped;
  for (const GrayBlock& gray : set.gray) {
    for (const BitFrames& bit : gray.bits) {
      for (const int frame : {bit.pattern, bit.inverse}) {
        if (frame < 0 || findings.is_disputed(frame)) {
          continue;
        }
        const double bright = set.bright_share(frame);
        if (bright > 1 - kNearlyAll && bright < kNearlyAll && own_contrast(set, frame) > 0.6) {
          striped.push_back(frame);
        }
      }
    }
  }
  for (const int frame : set.white) {
    const double bright = set.bright_share(frame);
    if (bright < kNearlyAll) {
      striped.push_back(frame);
    }
  }
  std::ranges::sort(striped);
  return striped;
}

void note_if_same(const SampledSet& set, Findings& findings, int a, int b, double least) {
  if (findings.is_disputed(a) || findings.is_disputed(b)) {
    return;
  }
  const double apart = difference(set, a, b);
  if (apart < least) {
    findings.fault(RCode::kFramesDoubled,
                   "frames " + std::to_string(a) + " and " + std::to_string(b) + " differ by " + percent(apart) +
                       " of the contrast only",
                   b);
    findings.dispute({a, b});
  }
}

}  // namespace

void judge_doubled(const SampledSet& set, Findings& findings) {
  const std::vector<int> striped = striped_frames(set, findings);
  for (std::size_t a = 0; a < striped.size(); ++a) {
    for (std::size_t b = a + 1; b < striped.size(); ++b) {
      note_if_same(set, findings, striped[a], striped[b], kSame);
    }
  }
  for (const PhaseBlock& phase : set.phase) {
    for (int a = 0; a < phase.block.steps; ++a) {
      for (int b = a + 1; b < phase.block.steps; ++b) {
        // Mean difference of two shifted sinusoids over their range; a view of less than a period makes it uncertain.
        const double turn = std::numbers::pi * (b - a) / phase.block.steps;
        const double usual = 2 / std::numbers::pi * std::abs(std::sin(turn));
        note_if_same(set, findings, phase.first + a, phase.first + b, 0.2 * usual);
      }
    }
  }
}

}  // namespace raysteer::calib::decode
