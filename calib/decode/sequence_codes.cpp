// Do the bits of each Gray code fit each other? Reads them and words the verdict of sequence_bits.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <vector>

#include "calib/decode/sequence_bits.hpp"
#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// A difference smaller than both is noise.
constexpr float kNoise = 0.04F;
constexpr float kNoiseLevels = 2;

BitReading reading(const SampledSet& set, const BitFrames& bit) {
  BitReading out{std::vector<std::uint8_t>(set.count(), kUndecided),
                 std::vector<std::uint8_t>(set.count(), kUndecided)};
  for (const std::size_t i : set.lit) {
    const float range = set.range(i);
    const float apart = bit.inverse >= 0 ? set.at(bit.pattern, i) - set.at(bit.inverse, i)
                                         : 2 * set.at(bit.pattern, i) - set.low[i] - set.high[i];
    const auto decide = [&](float margin) -> std::uint8_t {
      return apart > margin ? 1 : apart < -margin ? 0 : kUndecided;
    };
    out.sure[i] = decide(2 * kDecided * range);
    out.side[i] = decide(std::max(kNoiseLevels, kNoise * range));
  }
  return out;
}

std::vector<int> frames_of(const GrayBlock& gray, int bit) {
  const BitFrames& frames = gray.bits[static_cast<std::size_t>(bit)];
  std::vector<int> both{frames.pattern};
  if (frames.inverse >= 0) {
    both.push_back(frames.inverse);
  }
  std::ranges::sort(both);
  return both;
}

void complain(const GrayBlock& gray, const BitTable& table, const BitVerdict& verdict, Findings& findings) {
  const char* axis = gray.block.axis == Axis::kX ? "x" : "y";
  const std::string where = std::string("Gray code along ") + axis + ": ";
  if (!verdict.inverted.empty()) {
    std::vector<int> frames;
    for (const int bit : verdict.inverted) {
      std::ranges::copy(frames_of(gray, bit), std::back_inserter(frames));
    }
    std::ranges::sort(frames);
    findings.fault(
        RCode::kInverseSwapped,
        where + (verdict.all_inverted ? "all pairs, " : "") + list_of(frames) +
            (gray.block.inverse ? " show the inverse where the pattern is expected" : " show the complement"),
        frames.front());
  } else if (verdict.exchanged) {
    findings.fault(RCode::kFramesOutOfOrder,
                   where + list_of(frames_of(gray, verdict.exchanged->second)) + " are exchanged with " +
                       list_of(frames_of(gray, verdict.exchanged->first)),
                   frames_of(gray, verdict.exchanged->second).front());
  } else if (verdict.reversed) {
    findings.fault(RCode::kFramesOutOfOrder,
                   where + "the least significant bit comes first; set 'lsb_first' the other way");
  } else if (verdict.outside) {
    findings.fault(RCode::kFramesOutOfOrder,
                   where + percent(1 - table.in_panel) +
                       " of the codes lie outside the panel; are columns and rows exchanged, or is "
                       "the projector's size wrong?");
  } else if (verdict.misfit) {
    findings.fault(RCode::kFramesOutOfOrder,
                   where + list_of(frames_of(gray, *verdict.misfit)) + " do not fit the stripes of the other frames",
                   frames_of(gray, *verdict.misfit).front());
  }
}

}  // namespace

void judge_codes(const SampledSet& set, Findings& findings) {
  if (!findings.disputed.empty()) {
    return;  // bits of disputed frames would only repeat the complaint
  }
  for (const GrayBlock& gray : set.gray) {
    std::vector<BitReading> readings;
    for (const BitFrames& bit : gray.bits) {
      readings.push_back(reading(set, bit));
    }
    const int length = gray.block.axis == Axis::kX ? set.sequence.panel_width : set.sequence.panel_height;
    const auto stripes = static_cast<int>(std::ceil((length + gray.block.offset_px) / gray.block.stripe_px));
    const BitTable table = count_bits(readings, set.side, stripes);
    findings.report.codes_coherent = std::min(findings.report.codes_coherent, table.coherent);
    findings.report.codes_in_panel = std::min(findings.report.codes_in_panel, table.in_panel);
    complain(gray, table, judge(table), findings);
  }
}

}  // namespace raysteer::calib::decode
