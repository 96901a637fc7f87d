// The check of sequences on rendered sets of each kind of code: sound sets pass, each corruption has its own name.
#include "calib/decode/sequence_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/synth/noise.hpp"
#include "calib/synth/stage.hpp"

namespace raysteer::calib::decode {
namespace {

constexpr int kPanelWidth = 232;
constexpr int kPanelHeight = 176;
constexpr int kWidth = 192;
constexpr int kHeight = 144;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::uint64_t kSeeds[] = {1, 20, 303};

using Frame = std::vector<std::uint16_t>;

struct Set {
  PatternSequence sequence;
  int largest = 255;  // of the camera's levels
  std::vector<Frame> frames;

  int bits() const { return largest == 255 ? 8 : 16; }
  std::size_t gray(Axis axis, int bit, bool inverted = false) const {
    const std::vector<Pattern> all = sequence.patterns();
    const auto found = std::ranges::find_if(all, [&](const Pattern& pattern) {
      return pattern.block.kind == PatternKind::kGray && pattern.block.axis == axis && pattern.bit == bit &&
             pattern.inverted == inverted;
    });
    EXPECT_NE(found, all.end());
    return static_cast<std::size_t>(found - all.begin());
  }
  std::size_t first(PatternKind kind) const {
    const std::vector<Pattern> all = sequence.patterns();
    return static_cast<std::size_t>(
        std::ranges::find_if(all, [&](const Pattern& pattern) { return pattern.block.kind == kind; }) - all.begin());
  }
};

PatternSequence gray_sequence(bool inverse) {
  PatternSequence sequence{kPanelWidth, kPanelHeight, {}};
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    PatternBlock gray;
    gray.kind = PatternKind::kGray;
    gray.axis = axis;
    gray.bits = 8;
    gray.inverse = inverse;
    sequence.blocks.push_back(gray);
  }
  sequence.blocks.emplace_back().kind = PatternKind::kWhite;
  sequence.blocks.emplace_back().kind = PatternKind::kBlack;
  return sequence;
}

// A camera before a painted wall: a slanted view of the panel, paint of 10 to 20 px in size, a rim that the projector
// does not reach, blur, shot and read noise. All vary with the seed.
class Wall {
 public:
  explicit Wall(std::uint64_t seed) {
    synth::Noise noise(seed, 7);
    const double scale = noise.uniform(0.9, 1.1);
    const double tilt = noise.uniform(-0.08, 0.08);
    const double left = noise.uniform(5, 25);
    const double top = noise.uniform(5, 15);
    ambient_ = noise.uniform(0.03, 0.08);
    Wave paint[3];
    for (Wave& wave : paint) {
      const double turn = noise.uniform(0, kTurn);
      const double per_px = kTurn / noise.uniform(10, 20);
      wave = {per_px * std::cos(turn), per_px * std::sin(turn), noise.uniform(0, kTurn)};
    }
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        Place place{left + scale * x + tilt * y, top + scale * y - tilt * x, false, 0.55};
        place.reached =
            x >= 12 && place.x >= 0 && place.y >= 0 && place.x < kPanelWidth - 1 && place.y < kPanelHeight - 1;
        for (const Wave& wave : paint) {
          place.albedo += 0.09 * std::sin(wave.x * x + wave.y * y + wave.phase);
        }
        places_.push_back(place);
      }
    }
    for (std::size_t i = 0; i < 2 * places_.size(); ++i) {
      noise_.push_back(noise.normal());
    }
  }

  Set show(PatternSequence sequence, int largest) const {
    Set set{std::move(sequence), largest, {}};
    for (const Pattern& pattern : set.sequence.patterns()) {
      set.frames.push_back(photograph(pattern, largest, set.frames.size()));
    }
    return set;
  }

 private:
  struct Wave {
    double x = 0, y = 0, phase = 0;
  };
  struct Place {
    double x = 0, y = 0;  // panel px
    bool reached = false;
    double albedo = 0;
  };

  // The pattern along its axis behind the blur of both lenses: one panel pixel either side.
  static std::vector<double> profile(const Pattern& pattern, int length) {
    const auto light = [&](int at) {
      return at < 0 || at >= length
                 ? 0.0
                 : pattern.value(pattern.block.axis == Axis::kX ? at : 0, pattern.block.axis == Axis::kX ? 0 : at);
    };
    std::vector<double> blurred;
    for (int at = 0; at < length; ++at) {
      blurred.push_back(0.25 * light(at - 1) + 0.5 * light(at) + 0.25 * light(at + 1));
    }
    return blurred;
  }

  Frame photograph(const Pattern& pattern, int largest, std::size_t index) const {
    const bool along_x = pattern.block.axis == Axis::kX;
    const std::vector<double> light = profile(pattern, along_x ? kPanelWidth : kPanelHeight);
    // Each frame starts elsewhere in the noise: drawing it anew would take most of the time.
    std::size_t next = index * 7919 % places_.size();
    Frame frame;
    frame.reserve(places_.size());
    for (const Place& place : places_) {
      const double at = std::max(along_x ? place.x : place.y, 0.0);
      const auto before = static_cast<std::size_t>(at);
      const double part = at - static_cast<double>(before);
      const double shown = place.reached ? (1 - part) * light[before] + part * light[before + 1] : 0;
      const double level = 255 * place.albedo * (ambient_ + 0.85 * shown);
      const double seen = level + noise_[next++] * std::sqrt(0.5 + level / 60);
      frame.push_back(static_cast<std::uint16_t>(std::clamp(seen / 255, 0.0, 1.0) * largest + 0.5));
    }
    return frame;
  }

  double ambient_ = 0;
  std::vector<Place> places_;
  std::vector<double> noise_;
};

SequenceReport judge(const Set& set) {
  SequenceCheck check(set.sequence, {0, 0, kWidth, kHeight}, set.bits());
  for (std::size_t k = 0; k < set.frames.size(); ++k) {
    const int index = static_cast<int>(k);
    if (set.bits() == 8) {
      const std::vector<std::uint8_t> narrow(set.frames[k].begin(), set.frames[k].end());
      check.add(index, ImageView<const std::uint8_t>(narrow.data(), kWidth, kHeight));
    } else {
      check.add(index, ImageView<const std::uint16_t>(set.frames[k].data(), kWidth, kHeight));
    }
  }
  return check.report();
}

std::string text(const SequenceReport& report) {
  std::string all;
  for (const Error& error : report.faults) {
    all += to_string(error.rcode) + " " + error.message() + "\n";
  }
  return all.empty() ? "no fault\n" : all;
}

struct Kind {
  std::string name;
  PatternSequence sequence;
  int largest;
};

std::vector<Kind> kinds() {
  return {{"Gray without inverses", gray_sequence(false), 255},
          {"half-period Gray and phase", synth::half_period_sequence(kPanelWidth, kPanelHeight, false), 255},
          {"half-period Gray with inverses and phase", synth::half_period_sequence(kPanelWidth, kPanelHeight, true, 4),
           255},
          {"Gray in 12 of 16 bits", gray_sequence(true), 4095},
          {"Gray in 16 bits", gray_sequence(true), 65535}};
}

void expect_first(const Set& set, const std::string& what, const std::vector<RCode>& named) {
  const SequenceReport report = judge(set);
  ASSERT_FALSE(report.good()) << what;
  EXPECT_NE(std::ranges::find(named, report.faults.front().rcode), named.end()) << what << ": " << text(report);
}

void corrupt(const Set& sound, const std::string& what, const std::vector<RCode>& named,
             const std::function<void(std::vector<Frame>&)>& how) {
  Set set = sound;
  how(set.frames);
  expect_first(set, what, named);
}

// The camera turns left from frame `first` on: everything moves right by `px`.
void nudge(std::vector<Frame>& frames, std::size_t first, int px) {
  for (std::size_t k = first; k < frames.size(); ++k) {
    for (int y = 0; y < kHeight; ++y) {
      const auto row = frames[k].begin() + static_cast<std::ptrdiff_t>(y) * kWidth;
      std::copy_backward(row, row + kWidth - px, row + kWidth);
    }
  }
}

TEST(SequenceCheck, sound_sets_of_every_kind_pass) {
  for (const std::uint64_t seed : kSeeds) {
    const Wall wall(seed);
    for (const Kind& kind : kinds()) {
      const SequenceReport report = judge(wall.show(kind.sequence, kind.largest));
      EXPECT_TRUE(report.good() && report.warnings.empty()) << kind.name << ", seed " << seed << ": " << text(report);
      EXPECT_GT(report.lit, 0.7) << kind.name << ", seed " << seed;
      EXPECT_GT(report.contrast, 60) << kind.name << ", seed " << seed;
      EXPECT_LT(report.contrast, 180) << kind.name << ", seed " << seed;
      EXPECT_LT(report.largest_shift_px, 0.2) << kind.name << ", seed " << seed;
    }
  }
}

void for_each_kind(const std::function<void(const Set&, const std::string&)>& visit) {
  constexpr std::uint64_t kSeed = 77;
  static const Wall wall(kSeed);
  for (const Kind& kind : kinds()) {
    if (kind.largest == 65535) {
      continue;  // 12 bits must be recognised besides
    }
    visit(wall.show(kind.sequence, kind.largest), kind.name + ", seed " + std::to_string(kSeed) + ", ");
  }
}

TEST(CorruptedSets, are_refused_with_their_own_name) {
  for_each_kind([](const Set& sound, const std::string& name) {
    // The most significant bit has no coarser one that could check it.
    const int top = sound.sequence.blocks.front().bits - 1;
    const std::size_t fine = sound.gray(Axis::kX, top - 2);
    const std::size_t coarse = sound.gray(Axis::kX, top - 1);
    const std::size_t other = sound.gray(Axis::kY, top - 2);
    corrupt(sound, name + "bits swapped", {RCode::kFramesOutOfOrder}, [&](auto& f) { std::swap(f[fine], f[coarse]); });
    corrupt(sound, name + "axes swapped", {RCode::kFramesOutOfOrder}, [&](auto& f) { std::swap(f[coarse], f[other]); });
    corrupt(sound, name + "frame repeated", {RCode::kFramesDoubled}, [&](auto& f) { f[coarse] = f[fine]; });
    corrupt(sound, name + "frame black", {RCode::kFramesBlack},
            [&](auto& f) { f[coarse] = f[sound.first(PatternKind::kBlack)]; });
    corrupt(sound, name + "frame saturated", {RCode::kFramesSaturated},
            [&](auto& f) { std::ranges::fill(f[coarse], sound.largest); });
    corrupt(sound, name + "white and black swapped", {RCode::kFramesOutOfOrder, RCode::kFramesBlack},
            [](auto& f) { std::swap(f[f.size() - 1], f[f.size() - 2]); });
    corrupt(sound, name + "all black", {RCode::kFramesBlack},
            [&](auto& f) { std::ranges::fill(f, Frame(f[0].size(), static_cast<std::uint16_t>(sound.largest / 80))); });
    corrupt(sound, name + "projector off", {RCode::kFramesBlack},
            [&](auto& f) { std::ranges::fill(f, Frame(f[sound.first(PatternKind::kBlack)])); });
    corrupt(sound, name + "all saturated", {RCode::kFramesSaturated},
            [&](auto& f) { std::ranges::fill(f, Frame(f[0].size(), static_cast<std::uint16_t>(sound.largest))); });
    corrupt(sound, name + "moved", {RCode::kSceneMoved}, [](auto& f) { nudge(f, f.size() / 2, 3); });
  });
}

TEST(CorruptedSets, with_pattern_and_inverse_swapped_say_so) {
  for_each_kind([](const Set& sound, const std::string& name) {
    if (!sound.sequence.blocks.front().inverse) {
      return;
    }
    for (const int bit : {2, 3}) {
      corrupt(sound, name + "inverse of bit " + std::to_string(bit), {RCode::kInverseSwapped},
              [&](auto& f) { std::swap(f[sound.gray(Axis::kX, bit)], f[sound.gray(Axis::kX, bit, true)]); });
    }
  });
}

TEST(CorruptedSets, with_one_frame_complemented_say_so_without_inverses) {
  const Wall wall(9);
  const Set sound = wall.show(gray_sequence(false), 255);
  const Set pairs = wall.show(gray_sequence(true), 255);
  corrupt(sound, "complement of bit 4, seed 9", {RCode::kInverseSwapped},
          [&](auto& f) { f[sound.gray(Axis::kX, 4)] = pairs.frames[pairs.gray(Axis::kX, 4, true)]; });
}

TEST(CorruptedSets, with_faulty_steps_are_refused_with_their_own_name) {
  for_each_kind([](const Set& sound, const std::string& name) {
    if (sound.sequence.blocks[1].kind != PatternKind::kPhase) {
      return;
    }
    const std::size_t step = sound.first(PatternKind::kPhase);
    corrupt(sound, name + "steps swapped", {RCode::kFramesOutOfOrder},
            [&](auto& f) { std::swap(f[step], f[step + 1]); });
    corrupt(sound, name + "step repeated", {RCode::kFramesDoubled}, [&](auto& f) { f[step + 1] = f[step]; });
    corrupt(sound, name + "step black", {RCode::kFramesBlack},
            [&](auto& f) { f[step + 1] = f[sound.first(PatternKind::kBlack)]; });
    corrupt(sound, name + "step saturated", {RCode::kFramesSaturated},
            [&](auto& f) { std::ranges::fill(f[step + 1], sound.largest); });
  });
}

TEST(SequenceCheck, a_frame_that_did_not_come_is_refused) {
  const Set set = Wall(8).show(gray_sequence(false), 255);
  SequenceCheck check(set.sequence, {0, 0, kWidth, kHeight}, 16);
  for (std::size_t k = 1; k < set.frames.size(); ++k) {
    check.add(static_cast<int>(k), ImageView<const std::uint16_t>(set.frames[k].data(), kWidth, kHeight));
  }
  const Status verdict = check.verdict();
  ASSERT_FALSE(verdict);
  EXPECT_EQ(verdict.error().rcode, RCode::kFrameCount);
}

}  // namespace
}  // namespace raysteer::calib::decode
