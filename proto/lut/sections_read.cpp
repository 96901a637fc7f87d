#include <algorithm>

#include "proto/lut/bytes.hpp"
#include "proto/lut/sections.hpp"

namespace raysteer::proto::lut {
namespace {

Error damaged(std::string_view section) {
  return fail(RCode::kTableDamaged, std::string(section) + " is shorter or longer than its own numbers say");
}

}  // namespace

Result<Identity> read_identity(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  Identity identity{.calibration_id = reader.take_name(), .board_id = reader.take_name()};
  if (!reader.finished()) {
    return damaged("the identity");
  }
  for (const std::string& id : {identity.calibration_id, identity.board_id}) {
    if (id.empty() || id.size() > kLongestName) {
      return fail(RCode::kTableDamaged,
                  "ids of calibration and board have 1 to 64 bytes, got " + std::to_string(id.size()));
    }
  }
  return identity;
}

Result<SteeringTable> read_steering(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  SteeringTableParts parts;
  const auto frame = reader.take<std::uint32_t>();
  parts.frame = static_cast<Frame>(std::min<std::uint32_t>(frame, 255));
  for (double& value : parts.T_frame_plane) {
    value = reader.take_double();
  }
  for (double* value : {&parts.aim_px[0], &parts.aim_px[1], &parts.origin.x, &parts.origin.y, &parts.spacing_m,
                        &parts.bound_m, &parts.worst_m}) {
    *value = reader.take_double();
  }
  for (std::int32_t* nrad : {&parts.least_nrad[0], &parts.least_nrad[1], &parts.most_nrad[0], &parts.most_nrad[1],
                             &parts.columns, &parts.rows}) {
    *nrad = reader.take<std::int32_t>();
  }
  constexpr int kMost = SteeringTable::kMostNodes;
  if (parts.columns < 2 || parts.rows < 2 || parts.columns > kMost || parts.rows > kMost ||
      !reader.has(static_cast<std::uint64_t>(parts.columns) * static_cast<std::uint64_t>(parts.rows), 8)) {
    return damaged("the steering table");
  }
  parts.nodes.resize(static_cast<std::size_t>(parts.columns) * static_cast<std::size_t>(parts.rows));
  for (auto& node : parts.nodes) {
    node[0] = reader.take<std::int32_t>();
    node[1] = reader.take<std::int32_t>();
  }
  const auto reached =
      reader.take_bytes(static_cast<std::size_t>(parts.columns - 1) * static_cast<std::size_t>(parts.rows - 1));
  if (!reader.finished()) {
    return damaged("the steering table");
  }
  parts.reached.assign(reached.begin(), reached.end());
  return SteeringTable::make(std::move(parts));
}

Result<std::vector<KeepOut>> read_keep_out(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  std::vector<KeepOut> zones;
  const auto count = reader.take<std::uint32_t>();
  for (std::uint32_t i = 0; i < count && reader.has(1, 5); ++i) {
    KeepOut zone{.name = reader.take_name(), .corners = {}};
    const auto corners = reader.take<std::uint32_t>();
    if (!reader.has(corners, 16)) {
      break;
    }
    for (std::uint32_t k = 0; k < corners; ++k) {
      const double x = reader.take_double();
      const double y = reader.take_double();
      zone.corners.push_back({x, y});
    }
    RAYSTEER_TRY(check(zone));
    zones.push_back(std::move(zone));
  }
  if (!reader.finished() || zones.size() != count) {
    return damaged("the list of keep-out zones");
  }
  return zones;
}

Result<WarpMap> read_warp_map(std::span<const std::uint8_t> bytes) {
  ByteReader reader(bytes);
  WarpMapParts parts;
  parts.name = reader.take_name();
  for (int* value : {&parts.panel_width, &parts.panel_height, &parts.content_width, &parts.content_height,
                     &parts.command_nrad[0], &parts.command_nrad[1], &parts.cell_px, &parts.exponent}) {
    *value = reader.take<std::int32_t>();
  }
  for (double* value :
       {&parts.bound_px, &parts.worst_px, &parts.gain_bound, &parts.boost, &parts.metres_per_px, &parts.tolerance_m}) {
    *value = reader.take_double();
  }
  // Sizes first: the counts of everything else follow from them.
  const auto side_fits = [](int side) { return side >= 1 && side <= kLargestSide; };
  if (!side_fits(parts.panel_width) || !side_fits(parts.panel_height) || parts.cell_px < 8 ||
      parts.cell_px > kLargestCell) {
    return fail(RCode::kTableDamaged, "a warp map's panel or cells have a size that cannot be");
  }
  const auto columns = static_cast<std::size_t>(parts.columns());
  const auto rows = static_cast<std::size_t>(parts.rows());
  const auto area = static_cast<std::size_t>(parts.cell_px) * static_cast<std::size_t>(parts.cell_px);
  std::size_t masked = 0;
  std::size_t dense = 0;
  for (const std::uint8_t kind : reader.take_bytes(columns * rows)) {
    parts.cells.push_back(static_cast<CellKind>(kind));
    masked += parts.cells.back() == CellKind::kMasked ? 1 : 0;
    dense += parts.cells.back() == CellKind::kDense ? 1 : 0;
  }
  if (!reader.has((columns + 1) * (rows + 1), 14)) {
    return damaged("a warp map");
  }
  parts.nodes.resize((columns + 1) * (rows + 1));
  for (WarpNode& node : parts.nodes) {
    node.u = reader.take<std::int32_t>();
    node.v = reader.take<std::int32_t>();
    node.w = reader.take<std::int32_t>();
    node.gain = reader.take<std::uint16_t>();
  }
  const auto masks = reader.take_bytes(masked * area / 8);
  parts.masks.assign(masks.begin(), masks.end());
  if (!reader.has(dense * area, 10)) {
    return damaged("a warp map");
  }
  parts.dense.resize(dense * area);
  for (WarpSample& sample : parts.dense) {
    sample.u = reader.take<std::int32_t>();
    sample.v = reader.take<std::int32_t>();
    sample.gain = reader.take<std::uint16_t>();
  }
  if (!reader.finished()) {
    return damaged("a warp map");
  }
  return WarpMap::make(std::move(parts));
}

}  // namespace raysteer::proto::lut
