#include "calib/decode/sequence_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "calib/decode/sequence_bits.hpp"
#include "calib/decode/sequence_motion.hpp"

namespace raysteer::calib::decode {
namespace {

// 24 px hold three stripes of 8 px or a shift of 6 px; 280 tiles are 160,000 samples, 5 % of a frame of 3 Mpx.
constexpr int kTileSide = 24;
constexpr int kMostTiles = 280;
// Below this many levels between brightest and darkest the projector does not reach a place.
constexpr float kLitLevels = 10;
constexpr float kSaturatedLevel = 250;
// A set with less of the view lit than this is taken for one that the projector does not reach.
constexpr double kLeastLit = 0.004;
// A place is bright or dark when it lies this far from the middle of its own range, of which 1 is the whole.
constexpr float kDecided = 0.15F;
// A difference smaller than both is noise.
constexpr float kNoise = 0.04F;
constexpr float kNoiseLevels = 2;
// Share of the decided places that may contradict the pattern's complement. The three public sets stay below 0.03;
// an exchanged frame gives 0.3 to 1.
constexpr double kMostContradicting = 0.12;
// Two frames are "the same" when they differ by less than this part of the contrast; exchanged stripes give 0.3 and
// more.
constexpr double kSame = 0.08;
// A frame shows next to nothing but bright, or nothing but dark, beyond this share: its stripe edges are out of view.
constexpr double kNearlyAll = 0.9;
// Movement, camera px. The public stereo set drifts by 0.8 px and is usable; a nudge that spoils a code is larger.
constexpr double kWarnShift = 0.3;
constexpr double kMostShift = 1.5;
// Share of the samples that may change besides.
constexpr double kMostChanged = 0.04;
// Median departure from the sinusoid over its amplitude: 0.12 in the public set (its projector has a gamma), 0.05 when
// linear; exchanged or repeated steps give 0.4 and more.
constexpr double kMostPhaseResidual = 0.3;

std::string percent(double share) {
  const int tenths = static_cast<int>(std::lround(1000 * share));
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " %";
}

std::string fixed(double value) {
  const long hundredths = std::lround(100 * value);
  const std::string digits = std::to_string(hundredths % 100);
  return std::to_string(hundredths / 100) + "." + (digits.size() < 2 ? "0" : "") + digits;
}

std::string list_of(const std::vector<int>& frames) {
  constexpr std::size_t kMostNamed = 8;
  std::string text = frames.size() == 1 ? "frame " : "frames ";
  for (std::size_t i = 0; i < std::min(frames.size(), kMostNamed); ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(frames[i]);
  }
  return frames.size() > kMostNamed ? text + " and " + std::to_string(frames.size() - kMostNamed) + " more" : text;
}

float percentile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Pattern, and its inverse if there is one.
struct BitFrames {
  int bit = 0;
  int pattern = -1;
  int inverse = -1;
};

struct GrayBlock {
  PatternBlock block;
  std::vector<BitFrames> bits;
};

struct PhaseBlock {
  PatternBlock block;
  int first = 0;
};

// One judgement of one set of samples; each step looks only at what the steps before left undisputed.
class Judgement {
 public:
  Judgement(const PatternSequence& sequence, const std::vector<std::vector<std::uint16_t>>& samples, int bits, int side)
      : patterns_(sequence.patterns()), sequence_(sequence), samples_(samples), side_(side) {
    level_ = 255.0F / full_scale(bits);
    sort_frames();
  }

  SequenceReport run() {
    find_range();
    if (!judge_light()) {
      return std::move(report_);
    }
    judge_single_frames();
    judge_doubled();
    read_states();
    judge_references();
    judge_complements();
    judge_bits();
    judge_phase();
    judge_movement();
    settle();
    return std::move(report_);
  }

 private:
  std::size_t count() const { return samples_.front().size(); }
  float at(int frame, std::size_t i) const { return level_ * samples_[static_cast<std::size_t>(frame)][i]; }
  int frames() const { return static_cast<int>(samples_.size()); }
  void fault(RCode rcode, std::string note, int frame = -1) {
    report_.faults.push_back(fail(rcode, std::move(note), frame));
  }
  bool disputed(int frame) const { return std::ranges::find(disputed_, frame) != disputed_.end(); }

  float full_scale(int bits) const {
    if (bits == 8) {
      return 255;
    }
    std::uint16_t largest = 0;
    for (const auto& frame : samples_) {
      largest = std::max(largest, *std::ranges::max_element(frame));
    }
    for (const int depth : {10, 12, 14}) {
      if (largest < 1 << depth) {
        return static_cast<float>((1 << depth) - 1);
      }
    }
    return 65535;
  }

  void sort_frames() {
    for (int k = 0; k < frames(); ++k) {
      const Pattern& pattern = patterns_[static_cast<std::size_t>(k)];
      const bool begins = k == 0 || patterns_[static_cast<std::size_t>(k) - 1].block_index != pattern.block_index;
      switch (pattern.block.kind) {
        case PatternKind::kWhite:
          white_.push_back(k);
          break;
        case PatternKind::kBlack:
          black_.push_back(k);
          break;
        case PatternKind::kPhase:
          if (begins) {
            phase_.push_back({pattern.block, k});
          }
          break;
        case PatternKind::kGray: {
          if (begins) {
            gray_.push_back({pattern.block, {}});
            gray_.back().bits.resize(static_cast<std::size_t>(pattern.block.bits));
          }
          BitFrames& bit = gray_.back().bits[static_cast<std::size_t>(pattern.bit)];
          bit.bit = pattern.bit;
          (pattern.inverted ? bit.inverse : bit.pattern) = k;
          break;
        }
      }
    }
  }

  // The darkest and brightest each place gets. An average over pairs of pattern and inverse, since one bad frame then
  // does little harm; the references, or simply all frames, where there are no pairs.
  void find_range() {
    std::vector<std::pair<int, int>> groups;  // first frame, number
    for (const GrayBlock& gray : gray_) {
      for (const BitFrames& bit : gray.bits) {
        if (bit.inverse >= 0) {
          groups.emplace_back(std::min(bit.pattern, bit.inverse), 2);
        }
      }
    }
    for (const PhaseBlock& phase : phase_) {
      groups.emplace_back(phase.first, phase.block.steps);
    }
    if (groups.empty()) {
      groups.emplace_back(0, frames());
    }
    low_.assign(count(), 0);
    high_.assign(count(), 0);
    for (std::size_t i = 0; i < count(); ++i) {
      float low = 0;
      float high = 0;
      for (const auto& [first, number] : groups) {
        float least = at(first, i);
        float most = least;
        for (int k = first + 1; k < first + number; ++k) {
          least = std::min(least, at(k, i));
          most = std::max(most, at(k, i));
        }
        low += least;
        high += most;
      }
      low_[i] = low / static_cast<float>(groups.size());
      high_[i] = high / static_cast<float>(groups.size());
    }
  }

  bool coded() const { return !gray_.empty() || !phase_.empty(); }

  // All black, all saturated, or a projector that shows nothing. False: nothing more can be said.
  bool judge_light() {
    report_.brightest = percentile(high_, 0.99);
    std::size_t always_saturated = 0;
    std::size_t sometimes = 0;
    for (std::size_t i = 0; i < count(); ++i) {
      always_saturated += low_[i] >= kSaturatedLevel ? 1 : 0;
      if (high_[i] - low_[i] > kLitLevels) {
        lit_.push_back(i);
      }
    }
    report_.lit = static_cast<double>(lit_.size()) / static_cast<double>(count());
    if (report_.brightest < kLitLevels) {
      fault(RCode::kFramesBlack, "the brightest of all frames reaches " + fixed(report_.brightest) + " of 255 levels");
      return false;
    }
    const double saturated = static_cast<double>(always_saturated) / static_cast<double>(count());
    if (saturated > 0.5) {
      fault(RCode::kFramesSaturated, percent(saturated) + " of the view is saturated in every frame");
      return false;
    }
    if (!coded()) {
      return false;
    }
    if (report_.lit < kLeastLit) {
      fault(RCode::kFramesBlack, "the projector's patterns are not seen: only " + percent(report_.lit) +
                                     " of the view changes by more than " + fixed(kLitLevels) + " levels");
      return false;
    }
    std::vector<float> contrasts;
    const std::vector<int> bright = white_.empty() ? std::vector<int>{} : white_;
    for (const std::size_t i : lit_) {
      contrasts.push_back(high_[i] - low_[i]);
      const bool clipped = bright.empty() ? high_[i] >= kSaturatedLevel : at(bright.front(), i) >= kSaturatedLevel;
      sometimes += clipped ? 1 : 0;
    }
    report_.contrast = percentile(contrasts, 0.5);
    report_.saturated = static_cast<double>(sometimes) / static_cast<double>(lit_.size());
    const std::string note = percent(report_.saturated) + " of the lit view saturates in the brightest frame";
    // Binary stripes survive saturation as long as dark stays dark; a sinusoid does not.
    if (report_.saturated > 0.5 && !phase_.empty()) {
      fault(RCode::kFramesSaturated, note + "; a phase cannot be read there");
    } else if (report_.saturated > 0.2) {
      report_.warnings.push_back(fail(RCode::kFramesSaturated, note));
    }
    return true;
  }

  // Share of the lit samples of a frame that lie above (or below) a place in their own range.
  double bright_share(int frame) const {
    std::size_t bright = 0;
    for (const std::size_t i : lit_) {
      bright += at(frame, i) > 0.5F * (low_[i] + high_[i]) ? 1 : 0;
    }
    return static_cast<double>(bright) / static_cast<double>(lit_.size());
  }

  // Frames that lost their light, or have too much, while the others are sound.
  void judge_single_frames() {
    std::vector<int> dark;
    std::vector<int> clipped;
    const std::size_t stride = std::max<std::size_t>(1, count() / 20000);
    for (int k = 0; k < frames(); ++k) {
      const PatternKind kind = patterns_[static_cast<std::size_t>(k)].block.kind;
      std::size_t full = 0;
      std::size_t looked = 0;
      for (std::size_t i = 0; i < count(); i += stride, ++looked) {
        full += at(k, i) >= kSaturatedLevel ? 1 : 0;
      }
      // Dark places between the stripes, and those the projector does not reach, keep a sound frame below this.
      if (static_cast<double>(full) > 0.95 * static_cast<double>(looked)) {
        clipped.push_back(k);
        continue;
      }
      const double bright = bright_share(k);
      if (kind == PatternKind::kWhite && bright < 1 - kNearlyAll) {
        dark.push_back(k);
      } else if (kind == PatternKind::kPhase && bright < 0.02) {
        dark.push_back(k);
      } else if (kind == PatternKind::kGray && bright < 0.02) {
        const int partner = partner_of(k);
        if (partner >= 0 && bright_share(partner) < kNearlyAll) {
          dark.push_back(k);
        }
      }
    }
    if (!clipped.empty()) {
      fault(RCode::kFramesSaturated, list_of(clipped) + " saturate all over the view", clipped.front());
    }
    if (!dark.empty()) {
      fault(RCode::kFramesBlack, list_of(dark) + (dark.size() == 1 ? " shows" : " show") + " no light of the projector",
            dark.front());
    }
    std::ranges::copy(clipped, std::back_inserter(disputed_));
    std::ranges::copy(dark, std::back_inserter(disputed_));
  }

  int partner_of(int frame) const {
    for (const GrayBlock& gray : gray_) {
      for (const BitFrames& bit : gray.bits) {
        if (bit.inverse >= 0 && (bit.pattern == frame || bit.inverse == frame)) {
          return bit.pattern == frame ? bit.inverse : bit.pattern;
        }
      }
    }
    return -1;
  }

  // Mean difference of two frames over the lit places, as a part of the contrast.
  double difference(int a, int b) const {
    const std::size_t stride = std::max<std::size_t>(1, lit_.size() / 6000);
    double sum = 0;
    double range = 0;
    for (std::size_t n = 0; n < lit_.size(); n += stride) {
      const std::size_t i = lit_[n];
      sum += std::abs(at(a, i) - at(b, i));
      range += high_[i] - low_[i];
    }
    return sum / range;
  }

  void judge_doubled() {
    // Only frames that show stripes: those of which all edges are out of view may rightly be alike.
    std::vector<int> striped;
    for (const GrayBlock& gray : gray_) {
      for (const BitFrames& bit : gray.bits) {
        for (const int frame : {bit.pattern, bit.inverse}) {
          if (frame < 0 || disputed(frame)) {
            continue;
          }
          const double bright = bright_share(frame);
          if (bright > 1 - kNearlyAll && bright < kNearlyAll && own_contrast(frame) > 0.6) {
            striped.push_back(frame);
          }
        }
      }
    }
    for (const int frame : white_) {
      const double bright = bright_share(frame);
      if (bright < kNearlyAll) {
        striped.push_back(frame);
      }
    }
    std::ranges::sort(striped);
    for (std::size_t a = 0; a < striped.size(); ++a) {
      for (std::size_t b = a + 1; b < striped.size(); ++b) {
        note_if_same(striped[a], striped[b], kSame);
      }
    }
    for (const PhaseBlock& phase : phase_) {
      for (int a = 0; a < phase.block.steps; ++a) {
        for (int b = a + 1; b < phase.block.steps; ++b) {
          // Mean difference of two shifted sinusoids over their range; a view of less than a period makes it uncertain.
          const double turn = std::numbers::pi * (b - a) / phase.block.steps;
          const double usual = 2 / std::numbers::pi * std::abs(std::sin(turn));
          note_if_same(phase.first + a, phase.first + b, 0.2 * usual);
        }
      }
    }
  }

  void note_if_same(int a, int b, double least) {
    if (disputed(a) || disputed(b)) {
      return;
    }
    const double apart = difference(a, b);
    if (apart < least) {
      fault(RCode::kFramesDoubled,
            "frames " + std::to_string(a) + " and " + std::to_string(b) + " differ by " + percent(apart) +
                " of the contrast only",
            b);
      disputed_.push_back(a);
      disputed_.push_back(b);
    }
  }

  // How far a frame's places lie from the middle of their range, on average; 1 is fully bright or dark.
  double own_contrast(int frame) const {
    const std::size_t stride = std::max<std::size_t>(1, lit_.size() / 6000);
    double sum = 0;
    double range = 0;
    for (std::size_t n = 0; n < lit_.size(); n += stride) {
      const std::size_t i = lit_[n];
      sum += std::abs(2 * at(frame, i) - low_[i] - high_[i]);
      range += high_[i] - low_[i];
    }
    return sum / range;
  }

  void read_states() {
    states_.resize(samples_.size());
    for (int k = 0; k < frames(); ++k) {
      if (patterns_[static_cast<std::size_t>(k)].block.kind == PatternKind::kPhase) {
        continue;
      }
      std::vector<std::uint8_t>& state = states_[static_cast<std::size_t>(k)];
      state.assign(count(), kUndecided);
      for (const std::size_t i : lit_) {
        const float middle = 0.5F * (low_[i] + high_[i]);
        const float margin = kDecided * (high_[i] - low_[i]);
        const float value = at(k, i);
        state[i] = value > middle + margin ? 1 : value < middle - margin ? 0 : kUndecided;
      }
    }
  }

  // Share of the decided lit places of a frame that are in `wrong`.
  double share_in(int frame, std::uint8_t wrong) const {
    const std::vector<std::uint8_t>& state = states_[static_cast<std::size_t>(frame)];
    std::size_t decided = 0;
    std::size_t bad = 0;
    for (const std::size_t i : lit_) {
      decided += state[i] != kUndecided ? 1 : 0;
      bad += state[i] == wrong ? 1 : 0;
    }
    return decided == 0 ? 0 : static_cast<double>(bad) / static_cast<double>(decided);
  }

  void judge_references() {
    if (gray_.empty()) {
      return;  // a sinusoid's range is not the references' range
    }
    const auto look = [&](const std::vector<int>& references, std::uint8_t wrong, const char* said, const char* seen) {
      for (const int frame : references) {
        const double share = share_in(frame, wrong);
        if (share > kMostContradicting && !disputed(frame)) {
          fault(RCode::kFramesOutOfOrder,
                "frame " + std::to_string(frame) + " should be all " + said + ", but " + percent(share) +
                    " of the lit view is " + seen,
                frame);
          disputed_.push_back(frame);
        }
      }
    };
    look(white_, 0, "white", "dark");
    const std::size_t before = report_.faults.size();
    look(black_, 1, "black", "bright");
    black_frame_lit_ = report_.faults.size() > before;
  }

  // Where white clips, both a pattern and its inverse can look bright.
  bool clips(std::size_t i) const {
    const float full = white_.empty() ? high_[i] : std::max(high_[i], at(white_.front(), i));
    return full >= kSaturatedLevel;
  }

  // Stripes of a few camera pixels: both a pattern and its inverse may come out as the same grey.
  bool too_fine(int frame) const {
    const std::vector<std::uint8_t>& state = states_[static_cast<std::size_t>(frame)];
    std::size_t decided = 0;
    std::size_t changes = 0;
    for (std::size_t row = 0; row < count(); row += static_cast<std::size_t>(side_)) {
      for (std::size_t i = row; i + 1 < row + static_cast<std::size_t>(side_); ++i) {
        decided += state[i] != kUndecided ? 1 : 0;
        changes += state[i] != state[i + 1] && state[i] != kUndecided ? 1 : 0;
      }
    }
    std::size_t changes_down = 0;
    for (std::size_t i = 0; i + static_cast<std::size_t>(side_) < count(); ++i) {
      changes_down += state[i] != state[i + static_cast<std::size_t>(side_)] && state[i] != kUndecided ? 1 : 0;
    }
    return std::max(changes, changes_down) > decided / 4;
  }

  // Do both read alike where they must differ?
  double contradiction(int a, int b) const {
    const std::vector<std::uint8_t>& first = states_[static_cast<std::size_t>(a)];
    const std::vector<std::uint8_t>& second = states_[static_cast<std::size_t>(b)];
    std::size_t decided = 0;
    std::size_t alike = 0;
    for (const std::size_t i : lit_) {
      if (first[i] == kUndecided || second[i] == kUndecided) {
        continue;
      }
      if (first[i] == 1 && second[i] == 1 && clips(i)) {
        continue;
      }
      ++decided;
      alike += first[i] == second[i] ? 1 : 0;
    }
    return decided < lit_.size() / 50 ? 0 : static_cast<double>(alike) / static_cast<double>(decided);
  }

  void judge_complements() {
    std::vector<BitFrames> broken;
    for (const GrayBlock& gray : gray_) {
      for (const BitFrames& bit : gray.bits) {
        if (bit.inverse >= 0 && !disputed(bit.pattern) && !disputed(bit.inverse) &&
            !(too_fine(bit.pattern) && too_fine(bit.inverse)) &&
            contradiction(bit.pattern, bit.inverse) > kMostContradicting) {
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
    if (const auto swap = find_swap(broken)) {
      note =
          "frames " + std::to_string(swap->first) + " and " + std::to_string(swap->second) + " seem exchanged: " + note;
    }
    broken_pairs_ = static_cast<int>(broken.size());
    std::ranges::copy(frames, std::back_inserter(disputed_));
    fault(RCode::kFramesOutOfOrder, std::move(note), frames.front());
  }

  // Two frames of two broken pairs whose exchange mends both.
  std::optional<std::pair<int, int>> find_swap(const std::vector<BitFrames>& broken) const {
    if (broken.size() != 2) {
      return std::nullopt;
    }
    const BitFrames& a = broken[0];
    const BitFrames& b = broken[1];
    for (const auto& [mine, stays] : {std::pair{a.pattern, a.inverse}, std::pair{a.inverse, a.pattern}}) {
      for (const auto& [theirs, other] : {std::pair{b.pattern, b.inverse}, std::pair{b.inverse, b.pattern}}) {
        if (contradiction(theirs, stays) < kMostContradicting && contradiction(mine, other) < kMostContradicting) {
          return std::pair{std::min(mine, theirs), std::max(mine, theirs)};
        }
      }
    }
    return std::nullopt;
  }

  BitReading reading(const BitFrames& bit) const {
    BitReading out{std::vector<std::uint8_t>(count(), kUndecided), std::vector<std::uint8_t>(count(), kUndecided)};
    for (const std::size_t i : lit_) {
      const float range = high_[i] - low_[i];
      const float apart =
          bit.inverse >= 0 ? at(bit.pattern, i) - at(bit.inverse, i) : 2 * at(bit.pattern, i) - low_[i] - high_[i];
      const auto decide = [&](float margin) -> std::uint8_t {
        return apart > margin ? 1 : apart < -margin ? 0 : kUndecided;
      };
      out.sure[i] = decide(2 * kDecided * range);
      out.side[i] = decide(std::max(kNoiseLevels, kNoise * range));
    }
    return out;
  }

  void judge_bits() {
    if (!disputed_.empty()) {
      return;  // bits of disputed frames would only repeat the complaint
    }
    for (const GrayBlock& gray : gray_) {
      std::vector<BitReading> readings;
      for (const BitFrames& bit : gray.bits) {
        readings.push_back(reading(bit));
      }
      const int length = gray.block.axis == Axis::kX ? sequence_.panel_width : sequence_.panel_height;
      const auto stripes = static_cast<int>(std::ceil((length + gray.block.offset_px) / gray.block.stripe_px));
      const BitTable table = count_bits(readings, side_, stripes);
      report_.codes_coherent = std::min(report_.codes_coherent, table.coherent);
      report_.codes_in_panel = std::min(report_.codes_in_panel, table.in_panel);
      complain(gray, table, judge(table));
    }
  }

  void complain(const GrayBlock& gray, const BitTable& table, const BitVerdict& verdict) {
    const char* axis = gray.block.axis == Axis::kX ? "x" : "y";
    const auto frames_of = [&](int bit) {
      const BitFrames& frames = gray.bits[static_cast<std::size_t>(bit)];
      std::vector<int> both{frames.pattern};
      if (frames.inverse >= 0) {
        both.push_back(frames.inverse);
      }
      std::ranges::sort(both);
      return both;
    };
    const std::string where = std::string("Gray code along ") + axis + ": ";
    if (!verdict.inverted.empty()) {
      std::vector<int> frames;
      for (const int bit : verdict.inverted) {
        std::ranges::copy(frames_of(bit), std::back_inserter(frames));
      }
      std::ranges::sort(frames);
      fault(RCode::kInverseSwapped,
            where + (verdict.all_inverted ? "all pairs, " : "") + list_of(frames) +
                (gray.block.inverse ? " show the inverse where the pattern is expected" : " show the complement"),
            frames.front());
    } else if (verdict.exchanged) {
      fault(RCode::kFramesOutOfOrder,
            where + list_of(frames_of(verdict.exchanged->second)) + " are exchanged with " +
                list_of(frames_of(verdict.exchanged->first)),
            frames_of(verdict.exchanged->second).front());
    } else if (verdict.reversed) {
      fault(RCode::kFramesOutOfOrder, where + "the least significant bit comes first; set 'lsb_first' the other way");
    } else if (verdict.outside) {
      fault(RCode::kFramesOutOfOrder, where + percent(1 - table.in_panel) +
                                          " of the codes lie outside the panel; are columns and rows exchanged, or is "
                                          "the projector's size wrong?");
    } else if (verdict.misfit) {
      misfit_ = frames_of(*verdict.misfit).front();
      fault(RCode::kFramesOutOfOrder,
            where + list_of(frames_of(*verdict.misfit)) + " do not fit the stripes of the other frames", misfit_);
    }
  }

  void judge_phase() {
    for (const PhaseBlock& phase : phase_) {
      const int steps = phase.block.steps;
      std::vector<float> residuals;
      const std::size_t stride = std::max<std::size_t>(1, lit_.size() / 20000);
      for (std::size_t n = 0; n < lit_.size(); n += stride) {
        std::complex<double> sum;
        double mean = 0;
        double squares = 0;
        for (int k = 0; k < steps; ++k) {
          const double value = at(phase.first + k, lit_[n]);
          sum += value * std::polar(1.0, 2 * std::numbers::pi * k / steps);
          mean += value / steps;
          squares += value * value / steps;
        }
        const double amplitude = 2 * std::abs(sum) / steps;
        const double left = squares - mean * mean - amplitude * amplitude / 2;
        residuals.push_back(static_cast<float>(std::sqrt(std::max(left, 0.0)) / std::max(amplitude, 1e-6)));
      }
      const double residual = percentile(residuals, 0.5);
      report_.phase_residual = std::max(report_.phase_residual, residual);
      const bool known = std::ranges::any_of(
          disputed_, [&](int frame) { return frame >= phase.first && frame < phase.first + steps; });
      if (residual > kMostPhaseResidual && !known) {
        fault(RCode::kFramesOutOfOrder,
              "frames " + std::to_string(phase.first) + " to " + std::to_string(phase.first + steps - 1) +
                  " are not the steps of a shifted sinusoid: they depart from one by " + fixed(residual) +
                  " of its amplitude",
              phase.first);
      }
    }
  }

  // Groups of frames that add up to the same picture whatever they show: pattern and inverse, all steps of a sinusoid,
  // white and black. What differs between two such sums has moved.
  struct Group {
    std::vector<int> frames;
    float weight = 1;
  };

  std::vector<Group> groups() const {
    std::vector<Group> all;
    for (const GrayBlock& gray : gray_) {
      for (const BitFrames& bit : gray.bits) {
        if (bit.inverse >= 0) {
          all.push_back({{bit.pattern, bit.inverse}, 1});
        }
      }
    }
    for (const PhaseBlock& phase : phase_) {
      Group group{{}, 2.0F / static_cast<float>(phase.block.steps)};
      for (int k = 0; k < phase.block.steps; ++k) {
        group.frames.push_back(phase.first + k);
      }
      all.push_back(std::move(group));
    }
    // A projector with a gamma has another mean of white and black than of its sinusoids.
    if (!white_.empty() && !black_.empty() && phase_.empty()) {
      all.push_back({{white_.front(), black_.front()}, 1});
    }
    std::erase_if(all, [&](const Group& group) {
      return std::ranges::any_of(group.frames, [&](int frame) { return disputed(frame); });
    });
    std::ranges::sort(all, {}, [](const Group& group) { return std::ranges::min(group.frames); });
    return all;
  }

  Tiles sum_of(const Group& group) const {
    Tiles tiles{side_, std::vector<float>(count())};
    for (const int frame : group.frames) {
      for (std::size_t i = 0; i < count(); ++i) {
        tiles.levels[i] += group.weight * at(frame, i);
      }
    }
    return tiles;
  }

  void judge_movement() {
    const std::vector<Group> all = groups();
    if (all.size() < 2 || side_ < kTileSide) {
      return;
    }
    // Tiles that the projector reaches in part; what moves in the dark does no harm.
    std::vector<std::uint8_t> usable(count(), 0);
    const auto area = static_cast<std::size_t>(side_) * side_;
    for (const std::size_t i : lit_) {
      usable[i] = 1;
    }
    for (std::size_t base = 0; base < count(); base += area) {
      const auto tile = usable.begin() + static_cast<std::ptrdiff_t>(base);
      const auto lit = std::accumulate(tile, tile + static_cast<std::ptrdiff_t>(area), std::size_t{0});
      std::fill_n(tile, area, lit > area / 10 ? 1 : 0);
    }
    for (int k = 0; k < frames(); ++k) {
      for (std::size_t i = 0; i < count(); ++i) {
        usable[i] = at(k, i) >= kSaturatedLevel && !disputed(k) ? 0 : usable[i];
      }
    }
    const ShiftMeter meter(sum_of(all.front()), usable);
    std::vector<Shift> shifts{Shift{.known = true}};
    for (std::size_t n = 1; n < all.size(); ++n) {
      shifts.push_back(meter.measure(sum_of(all[n])));
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
    report_.largest_shift_px = shifts[farthest].length();
    const auto first_frame = [&](std::size_t n) { return std::ranges::min(all[n].frames); };
    if (report_.largest_shift_px > kMostShift) {
      fault(
          RCode::kSceneMoved,
          "by " + fixed(report_.largest_shift_px) + " px, most of it at frame " + std::to_string(first_frame(step_at)),
          first_frame(step_at));
    } else if (shifts[most_changed].changed > kMostChanged) {
      fault(RCode::kSceneMoved,
            percent(shifts[most_changed].changed) + " of the view changed by frame " +
                std::to_string(first_frame(most_changed)),
            first_frame(most_changed));
    } else if (report_.largest_shift_px > kWarnShift) {
      report_.warnings.push_back(fail(RCode::kSceneMoved,
                                      "slowly, by " + fixed(report_.largest_shift_px) + " px between frames 0 and " +
                                          std::to_string(first_frame(farthest)),
                                      first_frame(farthest)));
    }
  }

  // The cause before its consequences: a nudge makes the one pair it falls into contradict itself, and fine stripes
  // miss coarse ones.
  void settle() {
    const bool moved =
        std::ranges::any_of(report_.faults, [](const Error& error) { return error.rcode == RCode::kSceneMoved; });
    const auto first = [&](RCode rcode) {
      std::ranges::stable_partition(report_.faults, [&](const Error& error) { return error.rcode == rcode; });
    };
    if (moved && broken_pairs_ <= 1) {
      first(RCode::kSceneMoved);
    } else if (black_frame_lit_) {
      first(RCode::kFramesOutOfOrder);  // the black frame is elsewhere, where light is missing
    }
  }

  std::vector<Pattern> patterns_;
  const PatternSequence& sequence_;
  const std::vector<std::vector<std::uint16_t>>& samples_;
  int side_;
  float level_ = 1;
  std::vector<int> white_;
  std::vector<int> black_;
  std::vector<GrayBlock> gray_;
  std::vector<PhaseBlock> phase_;
  std::vector<float> low_;
  std::vector<float> high_;
  std::vector<std::size_t> lit_;
  std::vector<std::vector<std::uint8_t>> states_;
  std::vector<int> disputed_;  // frames that have a fault already
  int broken_pairs_ = 0;
  bool black_frame_lit_ = false;
  int misfit_ = -1;
  SequenceReport report_;
};

}  // namespace

SequenceCheck::SequenceCheck(const PatternSequence& sequence, int width, int height, int bits)
    : sequence_(sequence), bits_(bits), side_(std::min({kTileSide, width, height})) {
  samples_.resize(static_cast<std::size_t>(sequence.frames()));
  if (side_ < 1) {
    return;
  }
  // About square spacing; rows of tiles stand in a brick bond (by the golden section), so that no vertical edge of a
  // stripe can hide between the columns of tiles.
  const double spacing =
      std::max<double>(side_, std::sqrt(static_cast<double>(width) * height / static_cast<double>(kMostTiles)));
  const int down = std::max(1, static_cast<int>(height / spacing));
  const int across = std::max(1, static_cast<int>(width / spacing));
  for (int row = 0; row < down; ++row) {
    const double offset = row * std::numbers::phi - std::floor(row * std::numbers::phi);
    for (int column = 0; column < across; ++column) {
      const double room_x = static_cast<double>(width) / across - side_;
      const double room_y = static_cast<double>(height) / down - side_;
      const double shift_y = (column * std::numbers::phi) - std::floor(column * std::numbers::phi);
      tiles_.push_back({static_cast<int>(column * static_cast<double>(width) / across + offset * std::max(room_x, 0.0)),
                        static_cast<int>(row * static_cast<double>(height) / down + shift_y * std::max(room_y, 0.0))});
    }
  }
}

template <class Pixel>
void SequenceCheck::take(int index, ImageView<const Pixel> frame) {
  std::vector<std::uint16_t>& out = samples_[static_cast<std::size_t>(index)];
  const auto area = static_cast<std::size_t>(side_) * side_;
  out.resize(tiles_.size() * area);
  auto to = out.begin();
  for (const Corner& corner : tiles_) {
    for (int y = 0; y < side_; ++y) {
      to = std::copy_n(frame.row(corner.y + y) + corner.x, side_, to);
    }
  }
}

void SequenceCheck::add(int index, ImageView<const std::uint8_t> frame) { take(index, frame); }
void SequenceCheck::add(int index, ImageView<const std::uint16_t> frame) { take(index, frame); }

SequenceReport SequenceCheck::report() const {
  const auto missing = std::ranges::count_if(samples_, [](const auto& frame) { return frame.empty(); });
  if (missing > 0 || samples_.empty()) {
    SequenceReport report;
    report.faults.push_back(
        fail(RCode::kFrameCount, "the sequence has " + std::to_string(samples_.size()) + " frames, " +
                                     std::to_string(static_cast<long>(samples_.size()) - missing) + " came"));
    return report;
  }
  return Judgement(sequence_, samples_, bits_, side_).run();
}

Status SequenceCheck::verdict() const {
  SequenceReport all = report();
  if (!all.faults.empty()) {
    return std::move(all.faults.front());
  }
  return ok();
}

}  // namespace raysteer::calib::decode
