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
// A frame that is bright in less of the lit view tells nothing: the rim of a sliver passes for movement.
constexpr double kLeastBright = 0.25;
// A place shows the white frame's level from this part of its range on; less is the blurred rim of a stripe, which
// passes for movement where a stripe is a few camera pixels wide. Noise widens the range of a dim place by some per
// cent.
constexpr float kFullyBright = 0.85F;

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

// By how much something had moved when a frame was taken.
struct Look {
  int frame = 0;
  Shift shift;
};

// Sums of groups against the first sum.
std::vector<Look> look_at_sums(const SampledSet& set, const Findings& findings,
                               const std::vector<std::uint8_t>& usable) {
  const std::vector<Group> all = groups(set, findings);
  std::vector<Look> looks;
  if (all.size() < 2) {
    return looks;
  }
  const ShiftMeter meter(sum_of(set, all.front()), usable);
  looks.push_back({all.front().first(), {.known = true}});
  for (std::size_t n = 1; n < all.size(); ++n) {
    looks.push_back({all[n].first(), meter.measure(sum_of(set, all[n]))});
  }
  return looks;
}

// Gray frames without inverses against the white frame, each where it is bright.
std::vector<Look> look_at_bright_places(const SampledSet& set, const Findings& findings,
                                        const std::vector<std::uint8_t>& usable) {
  std::vector<Look> looks;
  if (set.white.empty() || findings.is_disputed(set.white.front())) {
    return looks;
  }
  const int white = set.white.front();
  const Tiles reference = sum_of(set, {{white}});
  for (const GrayBlock& gray : set.gray) {
    for (const BitFrames& bit : gray.bits) {
      if (bit.inverse >= 0 || findings.is_disputed(bit.pattern) || set.bright_share(bit.pattern) < kLeastBright) {
        continue;
      }
      std::vector<std::uint8_t> bright = usable;
      for (std::size_t i = 0; i < set.count(); ++i) {
        bright[i] = set.at(bit.pattern, i) > set.low[i] + kFullyBright * set.range(i) ? bright[i] : 0;
      }
      looks.push_back({bit.pattern, ShiftMeter(reference, bright).measure(sum_of(set, {{bit.pattern}}))});
    }
  }
  if (!looks.empty()) {
    looks.push_back({white, {.known = true}});
  }
  std::ranges::sort(looks, {}, &Look::frame);
  return looks;
}

// Says the worst of `looks`, which are in the order of frames.
void tell(const std::vector<Look>& looks, Findings& findings) {
  std::size_t farthest = 0;
  std::size_t most_changed = 0;
  std::size_t step_at = 0;
  double step = 0;
  for (std::size_t n = 0; n < looks.size(); ++n) {
    const Shift& shift = looks[n].shift;
    if (shift.known && (!looks[farthest].shift.known || shift.length() > looks[farthest].shift.length())) {
      farthest = n;
    }
    if (shift.changed > looks[most_changed].shift.changed) {
      most_changed = n;
    }
    if (n > 0 && shift.known && looks[n - 1].shift.known) {
      const Shift& before = looks[n - 1].shift;
      const double here = std::hypot(shift.x - before.x, shift.y - before.y);
      step_at = here > step ? n : step_at;
      step = std::max(step, here);
    }
  }
  const double length = looks[farthest].shift.length();
  const double changed = looks[most_changed].shift.changed;
  findings.report.largest_shift_px = std::max(findings.report.largest_shift_px, length);
  if (length > kMostShift) {
    const int frame = looks[step_at].frame;
    findings.fault(RCode::kSceneMoved, "by " + fixed(length) + " px, most of it at frame " + std::to_string(frame),
                   frame);
  } else if (changed > kMostChanged) {
    const int frame = looks[most_changed].frame;
    findings.fault(RCode::kSceneMoved, percent(changed) + " of the view changed by frame " + std::to_string(frame),
                   frame);
  } else if (length > kWarnShift) {
    const int frame = looks[farthest].frame;
    findings.warn(RCode::kSceneMoved, "slowly, by " + fixed(length) + " px until frame " + std::to_string(frame),
                  frame);
  }
}

}  // namespace

void judge_movement(const SampledSet& set, Findings& findings) {
  if (set.side < kTileSide) {
    return;
  }
  const std::vector<std::uint8_t> usable = usable_samples(set, findings);
  for (const auto& look : {look_at_sums, look_at_bright_places}) {
    const std::vector<Look> looks = look(set, findings, usable);
    if (!looks.empty()) {
      tell(looks, findings);
    }
  }
}

}  // namespace raysteer::calib::decode
