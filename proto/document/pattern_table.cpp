#include "proto/document/pattern_table.hpp"

#include <array>
#include <optional>

namespace raysteer::proto::document {
namespace {

constexpr std::int64_t kLargestSide = 65535;

Axis read_axis(TomlTable& table) { return table.choice("axis", {"x", "y"}) == 0 ? Axis::kX : Axis::kY; }

void read_gray(TomlTable& table, PatternBlock& block) {
  block.axis = read_axis(table);
  block.bits = static_cast<int>(table.integer("bits", {1, 16}));
  block.stripe_px = table.number("stripe_px", {1e-3, kLargestSide}, block.stripe_px);
  block.offset_px = table.number("offset_px", {0, kLargestSide}, block.offset_px);
  block.inverse = table.flag("inverse", block.inverse);
  block.inverse_first = table.flag("inverse_first", block.inverse_first);
  block.lsb_first = table.flag("lsb_first", block.lsb_first);
  if (block.inverse_first && !block.inverse) {
    table.fault(RCode::kBadValue, "inverse_first", "needs 'inverse = true'");
  }
}

void read_phase(TomlTable& table, int panel_width, int panel_height, PatternBlock& block) {
  block.axis = read_axis(table);
  block.steps = static_cast<int>(table.integer("steps", {3, 64}));
  const int length = block.axis == Axis::kX ? panel_width : panel_height;
  if (table.has("periods")) {
    block.period_px = length / table.number("periods", {1e-3, kLargestSide});
    if (table.has("period_px")) {
      table.fault(RCode::kBadValue, "periods", "says the same as 'period_px'; give one of them");
    } else if (length == 0) {
      table.fault(RCode::kBadValue, "periods", "needs the panel's size, which is not known here; give 'period_px'");
    }
  }
  // Asked for in any case, so that both keys are known.
  const std::optional<double> given = block.period_px > 0 ? std::optional(block.period_px) : std::nullopt;
  block.period_px = table.number("period_px", {2, kLargestSide}, given);
  block.origin_px = table.number("origin_px", {-kLargestSide, kLargestSide}, block.origin_px);
  const std::int64_t sign = table.integer("sign", {-1, 1}, block.sign);
  if (sign == 0) {
    table.fault(RCode::kBadValue, "sign", "must be 1 or -1, got 0");
  }
  block.sign = sign < 0 ? -1 : 1;
}

}  // namespace

PatternBlock read_pattern_block(TomlTable& table, int panel_width, int panel_height, const Faults& faults) {
  constexpr std::array kKinds{PatternKind::kWhite, PatternKind::kBlack, PatternKind::kGray, PatternKind::kPhase};
  PatternBlock block;
  block.kind = kKinds.at(static_cast<std::size_t>(table.choice("kind", {"white", "black", "gray", "phase"})));
  if (faults.any()) {
    return block;  // without its kind, nobody knows which keys belong here
  }
  if (block.kind == PatternKind::kGray) {
    read_gray(table, block);
  } else if (block.kind == PatternKind::kPhase) {
    read_phase(table, panel_width, panel_height, block);
  }
  table.finish();
  return block;
}

}  // namespace raysteer::proto::document
