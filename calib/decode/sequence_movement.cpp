// Did the scene or the camera move between frames?
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/sequence_motion.hpp"
#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// Movement, camera px. The public stereo set drifts by 0.8 px and is usable; a nudge that spoils a code is larger.
constexpr double kWarnShift = 0.3;
constexpr double kMostShift = 1.5;
// Share of the samples that may change besides.
constexpr double kMostChanged = 0.04;

// Groups of frames that add up to the same picture whatever they show: pattern and inverse, all steps of a sinusoid,
// white and black. What differs between two such sums has moved.
struct Group {
  std::vector<int> frames;
  float weight = 1;
  int first() const { return std::ranges::min(frames); }
};

std::vector<Group> groups(const SampledSet& set, const Findings& findings) {
  std::vector<Group> all;
  for (const GrayBlock& gray : set.gray) {
    for (const BitFrames& bit : gray.bits) {
      if (bit.inverse >= 0) {
        all.push_back({{bit.pattern, bit.inverse}, 1});
      }
    }
  }
  for (const PhaseBlock& phase : set.phase) {
    Group group{{}, 2.0F / static_cast<float>(phase.block.steps)};
    for (int k = 0; k < phase.block.steps; ++k) {
      group.frames.push_back(phase.first + k);
    }
    all.push_back(std::move(group));
  }
  // A projector with a gamma has another mean of white and black than of its sinusoids.
  if (!set.white.empty() && !set.black.empty() && set.phase.empty()) {
    all.push_back({{set.white.front(), set.black.front()}, 1});
  }
  std::erase_if(all, [&](const Group& group) {
    return std::ranges::any_of(group.frames, [&](int frame) { return findings.is_disputed(frame); });
  });
  std::ranges::sort(all, {}, &Group::first);
  return all;
}

Tiles sum_of(const SampledSet& set, const Group& group) {
  Tiles tiles{set.side, std::vector<float>(set.count())};
  for (const int frame : group.frames) {
    for (std::size_t i = 0; i < set.count(); ++i) {
      tiles.levels[i] += group.weight * set.at(frame, i);
    }
  }
  return tiles;
}

// Tiles that the projector reaches in part, where nothing saturates; what moves in the dark does no harm.
std::vector<std::uint8_t> usable_samples(const SampledSet& set, const Findings& findings) {
  std::vector<std::uint8_t> usable(set.count(), 0);
  const auto area = static_cast<std::size_t>(set.side) * set.side;
  for (const std::size_t i : set.lit) {
    usable[i] = 1;
  }
  for (std::size_t base = 0; base < set.count(); base += area) {
    const auto tile = usable.begin() + static_cast<std::ptrdiff_t>(base);
    const auto lit = std::accumulate(tile, tile + static_cast<std::ptrdiff_t>(area), std::size_t{0});
    std::fill_n(tile, area, lit > area / 10 ? 1 : 0);
  }
  for (int k = 0; k < set.frames(); ++k) {
    for (std::size_t i = 0; i < set.count(); ++i) {
      usable[i] = set.at(k, i) >= kSaturatedLevel && !findings.is_disputed(k) ? 0 : usable[i];
    }
  }
  return usable;
}

}  // namespace

void judge_movement(const SampledSet& set, Findings& findings) {
  const std::vector<Group> all = groups(set, findings);
  if (all.size() < 2 || set.side < kTileSide) {
    return;
  }
  const ShiftMeter meter(sum_of(set, all.front()), usable_samples(set, findings));
  std::vector<Shift> shifts{Shift{.known = true}};
  for (std::size_t n = 1; n < all.size(); ++n) {
    shifts.push_back(meter.measure(sum_of(set, all[n])));
  }
  std::size_t farthest = 0;
  std::size_t most_changed = 0;
  std::size_t step_at = 0;
  double step = 0;
  for (std::size_t n = 0; n < shifts.size(); ++n) {
    if (shifts[n].known && shifts[n].length() > shifts[farthest].length()) {
      farthest = n;
    }
    if (shifts[n].changed > shifts[most_changed].changed) {
      most_changed = n;
    }
    if (n > 0 && shifts[n].known && shifts[n - 1].known) {
      const double here = std::hypot(shifts[n].x - shifts[n - 1].x, shifts[n].y - shifts[n - 1].y);
      step_at = here > step ? n : step_at;
      step = std::max(step, here);
    }
  }
  findings.report.largest_shift_px = shifts[farthest].length();
  if (findings.report.largest_shift_px > kMostShift) {
    findings.fault(RCode::kSceneMoved,
                   "by " + fixed(findings.report.largest_shift_px) + " px, most of it at frame " +
                       std::to_string(all[step_at].first()),
                   all[step_at].first());
  } else if (shifts[most_changed].changed > kMostChanged) {
    findings.fault(RCode::kSceneMoved,
                   percent(shifts[most_changed].changed) + " of the view changed by frame " +
                       std::to_string(all[most_changed].first()),
                   all[most_changed].first());
  } else if (findings.report.largest_shift_px > kWarnShift) {
    findings.warn(RCode::kSceneMoved,
                  "slowly, by " + fixed(findings.report.largest_shift_px) + " px between frames 0 and " +
                      std::to_string(all[farthest].first()),
                  all[farthest].first());
  }
}

}  // namespace raysteer::calib::decode
