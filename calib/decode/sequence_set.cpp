#include "calib/decode/sequence_set.hpp"

#include <algorithm>
#include <utility>

namespace raysteer::calib::decode {
namespace {

float full_scale(const Samples& samples, int bits) {
  if (bits == 8) {
    return 255;
  }
  std::uint16_t largest = 0;
  for (const auto& frame : samples) {
    largest = std::max(largest, *std::ranges::max_element(frame));
  }
  for (const int depth : {10, 12, 14}) {
    if (largest < 1 << depth) {
      return static_cast<float>((1 << depth) - 1);
    }
  }
  return 65535;
}

}  // namespace

SampledSet::SampledSet(const PatternSequence& shown, const Samples& samples, int bits, int tile_side)
    : sequence(shown),
      side(tile_side),
      patterns_(shown.patterns()),
      samples_(samples),
      level_(255.0F / full_scale(samples, bits)) {
  sort_frames();
  find_range();
}

void SampledSet::sort_frames() {
  for (int k = 0; k < frames(); ++k) {
    const Pattern& pattern = patterns_[static_cast<std::size_t>(k)];
    const bool begins = k == 0 || patterns_[static_cast<std::size_t>(k) - 1].block_index != pattern.block_index;
    switch (pattern.block.kind) {
      case PatternKind::kWhite:
        white.push_back(k);
        break;
      case PatternKind::kBlack:
        black.push_back(k);
        break;
      case PatternKind::kPhase:
        if (begins) {
          phase.push_back({pattern.block, k});
        }
        break;
      case PatternKind::kGray: {
        if (begins) {
          gray.push_back({pattern.block, {}});
          gray.back().bits.resize(static_cast<std::size_t>(pattern.block.bits));
        }
        BitFrames& bit = gray.back().bits[static_cast<std::size_t>(pattern.bit)];
        (pattern.inverted ? bit.inverse : bit.pattern) = k;
        break;
      }
    }
  }
}

// An average over pairs of pattern and inverse, since one bad frame then does little harm; the references, or simply
// all frames, where there are no pairs.
void SampledSet::find_range() {
  std::vector<std::pair<int, int>> groups;  // first frame, number
  for (const GrayBlock& block : gray) {
    for (const BitFrames& bit : block.bits) {
      if (bit.inverse >= 0) {
        groups.emplace_back(std::min(bit.pattern, bit.inverse), 2);
      }
    }
  }
  for (const PhaseBlock& block : phase) {
    groups.emplace_back(block.first, block.block.steps);
  }
  if (groups.empty()) {
    groups.emplace_back(0, frames());
  }
  low.assign(count(), 0);
  high.assign(count(), 0);
  for (std::size_t i = 0; i < count(); ++i) {
    for (const auto& [first, number] : groups) {
      float least = at(first, i);
      float most = least;
      for (int k = first + 1; k < first + number; ++k) {
        least = std::min(least, at(k, i));
        most = std::max(most, at(k, i));
      }
      low[i] += least;
      high[i] += most;
    }
    low[i] /= static_cast<float>(groups.size());
    high[i] /= static_cast<float>(groups.size());
    if (range(i) > kLitLevels) {
      lit.push_back(i);
    }
  }
}

double SampledSet::bright_share(int frame, float part) const {
  std::size_t bright = 0;
  for (const std::size_t i : lit) {
    bright += at(frame, i) > low[i] + part * range(i) ? 1 : 0;
  }
  return static_cast<double>(bright) / static_cast<double>(lit.size());
}

float percentile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace raysteer::calib::decode
