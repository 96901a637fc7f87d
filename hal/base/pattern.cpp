#include "hal/base/pattern.hpp"

#include <cmath>
#include <numbers>
#include <string>

namespace raysteer {

int PatternBlock::frames() const {
  switch (kind) {
    case PatternKind::kWhite:
    case PatternKind::kBlack:
      return 1;
    case PatternKind::kGray:
      return inverse ? 2 * bits : bits;
    case PatternKind::kPhase:
      return steps;
  }
  return 0;
}

double Pattern::value(int x, int y) const {
  const double position = block.axis == Axis::kX ? x : y;
  switch (block.kind) {
    case PatternKind::kWhite:
      return 1;
    case PatternKind::kBlack:
      return 0;
    case PatternKind::kGray: {
      const auto code = static_cast<unsigned>(std::floor((position + 0.5 + block.offset_px) / block.stripe_px));
      const bool on = ((code ^ (code >> 1U)) >> static_cast<unsigned>(bit)) & 1U;
      return on != inverted ? 1 : 0;
    }
    case PatternKind::kPhase: {
      constexpr double kTurn = 2 * std::numbers::pi;
      const double phase = kTurn * (position - block.origin_px) / block.period_px;
      return 0.5 + 0.5 * std::cos(phase - block.sign * kTurn * step / block.steps);
    }
  }
  return 0;
}

int PatternSequence::frames() const {
  int count = 0;
  for (const PatternBlock& block : blocks) {
    count += block.frames();
  }
  return count;
}

std::vector<Pattern> PatternSequence::patterns() const {
  std::vector<Pattern> all;
  for (int index = 0; index < static_cast<int>(blocks.size()); ++index) {
    const PatternBlock& block = blocks[static_cast<std::size_t>(index)];
    Pattern pattern{.block = block, .block_index = index};
    const int copies = block.kind == PatternKind::kGray && block.inverse ? 2 : 1;
    for (int k = 0; k < block.frames(); ++k) {
      if (block.kind == PatternKind::kGray) {
        const int place = k / copies;
        pattern.bit = block.lsb_first ? place : block.bits - 1 - place;
        pattern.inverted = copies == 2 && (k % 2 == 1) != block.inverse_first;
      }
      pattern.step = k;
      all.push_back(pattern);
    }
  }
  return all;
}

Status check(const PatternSequence& sequence) {
  if (sequence.panel_width < 1 || sequence.panel_height < 1) {
    return fail(RCode::kBadSequence, "the projector's width and height must be at least 1 pixel, got " +
                                         std::to_string(sequence.panel_width) + " x " +
                                         std::to_string(sequence.panel_height));
  }
  for (std::size_t i = 0; i < sequence.blocks.size(); ++i) {
    const PatternBlock& block = sequence.blocks[i];
    const std::string name = "block " + std::to_string(i + 1) + ": ";
    if (block.kind == PatternKind::kGray) {
      const int length = block.axis == Axis::kX ? sequence.panel_width : sequence.panel_height;
      if (block.bits < 1 || block.bits > 16) {
        return fail(RCode::kBadSequence, name + "bits must be 1 to 16, got " + std::to_string(block.bits));
      }
      if (!(block.stripe_px > 0) || !(block.offset_px >= 0)) {
        return fail(RCode::kBadSequence, name + "stripe_px must be positive and offset_px must not be negative");
      }
      const double codes = std::ceil((length + block.offset_px) / block.stripe_px);
      if (codes > std::ldexp(1.0, block.bits)) {
        return fail(RCode::kBadSequence, name + std::to_string(block.bits) + " bits code " +
                                             std::to_string(1 << block.bits) + " stripes, the panel has " +
                                             std::to_string(static_cast<long>(codes)));
      }
    } else if (block.kind == PatternKind::kPhase) {
      if (block.steps < 3 || block.steps > 64) {
        return fail(RCode::kBadSequence, name + "steps must be 3 to 64, got " + std::to_string(block.steps));
      }
      if (!(block.period_px >= 2)) {
        return fail(RCode::kBadSequence, name + "period_px must be at least 2");
      }
      if (block.sign != 1 && block.sign != -1) {
        return fail(RCode::kBadSequence, name + "sign must be 1 or -1");
      }
    }
  }
  return ok();
}

}  // namespace raysteer
