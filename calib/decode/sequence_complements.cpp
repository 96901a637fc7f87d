// Is white bright, black dark, and each inverse the complement of its pattern?
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/sequence_bits.hpp"
#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// Share of the decided places that may contradict the pattern's complement. The three public sets stay below 0.03;
// an exchanged frame gives 0.3 to 1.
constexpr double kMostContradicting = 0.12;

// What each frame reads at each sample: 0, 1 or kUndecided. Empty for steps of a sinusoid.
using States = std::vector<std::vector<std::uint8_t>>;

States read_states(const SampledSet& set) {
  States states(static_cast<std::size_t>(set.frames()));
  for (int k = 0; k < set.frames(); ++k) {
    if (set.kind(k) == PatternKind::kPhase) {
      continue;
    }
    std::vector<std::uint8_t>& state = states[static_cast<std::size_t>(k)];
    state.assign(set.count(), kUndecided);
    for (const std::size_t i : set.lit) {
      const float middle = 0.5F * (set.low[i] + set.high[i]);
      const float margin = kDecided * set.range(i);
      const float value = set.at(k, i);
      state[i] = value > middle + margin ? 1 : value < middle - margin ? 0 : kUndecided;
    }
  }
  return states;
}

// Share of the decided lit places of a frame that are in `wrong`.
double share_in(const SampledSet& set, const States& states, int frame, std::uint8_t wrong) {
  const std::vector<std::uint8_t>& state = states[static_cast<std::size_t>(frame)];
  std::size_t decided = 0;
  std::size_t bad = 0;
  for (const std::size_t i : set.lit) {
    decided += state[i] != kUndecided ? 1 : 0;
    bad += state[i] == wrong ? 1 : 0;
  }
  return decided == 0 ? 0 : static_cast<double>(bad) / static_cast<double>(decided);
}

void judge_references(const SampledSet& set, const States& states, Findings& findings) {
  if (set.gray.empty()) {
    return;  // a sinusoid's range is not the references' range
  }
  const auto look = [&](const std::vector<int>& references, std::uint8_t wrong, const char* said, const char* seen) {
    for (const int frame : references) {
      const double share = share_in(set, states, frame, wrong);
      if (share > kMostContradicting && !findings.is_disputed(frame)) {
        findings.fault(RCode::kFramesOutOfOrder,
                       "frame " + std::to_string(frame) + " should be all " + said + ", but " + percent(share) +
                           " of the lit view is " + seen,
                       frame);
        findings.disputed.push_back(frame);
      }
    }
  };
  look(set.white, 0, "white", "dark");
  const std::size_t before = findings.report.faults.size();
  look(set.black, 1, "black", "bright");
  findings.black_frame_lit = findings.report.faults.size() > before;
}

// Where white clips, both a pattern and its inverse can look bright.
bool clips(const SampledSet& set, std::size_t i) {
  const float full = set.white.empty() ? set.high[i] : std::max(set.high[i], set.at(set.white.front(), i));
  return full >= kSaturatedLevel;
}

// Stripes of a few camera pixels: both a pattern and its inverse may come out as the same grey.
bool too_fine(const SampledSet& set, const States& states, int frame) {
  const std::vector<std::uint8_t>& state = states[static_cast<std::size_t>(frame)];
  std::size_t decided = 0;
  std::size_t changes = 0;
  for (std::size_t row = 0; row < set.count(); row += static_cast<std::size_t>(set.side)) {
    for (std::size_t i = row; i + 1 < row + static_cast<std::size_t>(set.side); ++i) {
      decided += state[i] != kUndecided ? 1 : 0;
      changes += state[i] != state[i + 1] && state[i] != kUndecided ? 1 : 0;
    }
  }
  std::size_t changes_down = 0;
  for (std::size_t i = 0; i + static_cast<std::size_t>(set.side) < set.count(); ++i) {
    changes_down += state[i] != state[i + static_cast<std::size_t>(set.side)] && state[i] != kUndecided ? 1 : 0;
  }
  return std::max(changes, changes_down) > decided / 4;
}

// Do both read alike where they must differ?
double contradiction(const SampledSet& set, const States& states, int a, int b) {
  const std::vector<std::uint8_t>& first = states[static_cast<std::size_t>(a)];
  const std::vector<std::uint8_t>& second = states[static_cast<std::size_t>(b)];
  std::size_t decided = 0;
  std::size_t alike = 0;
  for (const std::size_t i : set.lit) {
    if (first[i] == kUndecided || second[i] == kUndecided) {
      continue;
    }
    if (first[i] == 1 && second[i] == 1 && clips(set, i)) {
      continue;
    }
    ++decided;
    alike += first[i] == second[i] ? 1 : 0;
  }
  return decided < set.lit.size() / 50 ? 0 : static_cast<double>(alike) / static_cast<double>(decided);
}

// Two frames of two broken pairs whose exchange mends both.
std::optional<std::pair<int, int>> find_swap(const SampledSet& set, const States& states,
                                             const std::vector<BitFrames>& broken) {
  if (broken.size() != 2) {
    return std::nullopt;
  }
  const BitFrames& a = broken[0];
  const BitFrames& b = broken[1];
  for (const auto& [mine, stays] : {std::pair{a.pattern, a.inverse}, std::pair{a.inverse, a.pattern}}) {
    for (const auto& [theirs, other] : {std::pair{b.pattern, b.inverse}, std::pair{b.inverse, b.pattern}}) {
      if (contradiction(set, states, theirs, stays) < kMostContradicting &&
          contradiction(set, states, mine, other) < kMostContradicting) {
        return std::pair{std::min(mine, theirs), std::max(mine, theirs)};
      }
    }
  }
  return std::nullopt;
}

void judge_pairs(const SampledSet& set, const States& states, Findings& findings) {
  std::vector<BitFrames> broken;
  for (const GrayBlock& gray : set.gray) {
    for (const BitFrames& bit : gray.bits) {
      if (bit.inverse >= 0 && !findings.is_disputed(bit.pattern) && !findings.is_disputed(bit.inverse) &&
          !(too_fine(set, states, bit.pattern) && too_fine(set, states, bit.inverse)) &&
          contradiction(set, states, bit.pattern, bit.inverse) > kMostContradicting) {
        broken.push_back(bit);
      }
    }
  }
  if (broken.empty()) {
    return;
  }
  std::vector<int> frames;
  for (const BitFrames& bit : broken) {
    frames.push_back(std::min(bit.pattern, bit.inverse));
    frames.push_back(std::max(bit.pattern, bit.inverse));
  }
  std::ranges::sort(frames);
  std::string note = list_of(frames) + ": patterns and inverses do not complement each other";
  if (const auto swap = find_swap(set, states, broken)) {
    note =
        "frames " + std::to_string(swap->first) + " and " + std::to_string(swap->second) + " seem exchanged: " + note;
  }
  findings.broken_pairs = static_cast<int>(broken.size());
  findings.dispute(frames);
  findings.fault(RCode::kFramesOutOfOrder, std::move(note), frames.front());
}

}  // namespace

void judge_complements(const SampledSet& set, Findings& findings) {
  const States states = read_states(set);
  judge_references(set, states, findings);
  judge_pairs(set, states, findings);
}

}  // namespace raysteer::calib::decode
