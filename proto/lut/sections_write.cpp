#include "proto/lut/bytes.hpp"
#include "proto/lut/sections.hpp"

namespace raysteer::proto::lut {

std::vector<std::uint8_t> write_identity(const Identity& identity) {
  ByteWriter writer;
  writer.put_name(identity.calibration_id);
  writer.put_name(identity.board_id);
  return writer.take();
}

std::vector<std::uint8_t> write_steering(const SteeringTable& table) {
  const SteeringTableParts& parts = table.parts();
  ByteWriter writer;
  writer.put(static_cast<std::uint32_t>(parts.frame));
  for (const double value : parts.T_frame_plane) {
    writer.put(value);
  }
  for (const double value : {parts.aim_px[0], parts.aim_px[1], parts.origin.x, parts.origin.y, parts.spacing_m,
                             parts.bound_m, parts.worst_m}) {
    writer.put(value);
  }
  for (const std::int32_t nrad :
       {parts.least_nrad[0], parts.least_nrad[1], parts.most_nrad[0], parts.most_nrad[1], parts.columns, parts.rows}) {
    writer.put(nrad);
  }
  for (const auto& node : parts.nodes) {
    writer.put(node[0]);
    writer.put(node[1]);
  }
  writer.put(parts.reached);
  return writer.take();
}

std::vector<std::uint8_t> write_keep_out(std::span<const KeepOut> zones) {
  ByteWriter writer;
  writer.put(static_cast<std::uint32_t>(zones.size()));
  for (const KeepOut& zone : zones) {
    writer.put_name(zone.name);
    writer.put(static_cast<std::uint32_t>(zone.corners.size()));
    for (const PlanePoint& corner : zone.corners) {
      writer.put(corner.x);
      writer.put(corner.y);
    }
  }
  return writer.take();
}

std::vector<std::uint8_t> write_warp_map(const WarpMap& map) {
  const WarpMapParts& parts = map.parts();
  ByteWriter writer;
  writer.put_name(parts.name);
  for (const std::int32_t value : {parts.panel_width, parts.panel_height, parts.content_width, parts.content_height,
                                   parts.command_nrad[0], parts.command_nrad[1], parts.cell_px, parts.exponent}) {
    writer.put(value);
  }
  for (const double value :
       {parts.bound_px, parts.worst_px, parts.gain_bound, parts.boost, parts.metres_per_px, parts.tolerance_m}) {
    writer.put(value);
  }
  for (const CellKind kind : parts.cells) {
    writer.put(static_cast<std::uint8_t>(kind));
  }
  for (const WarpNode& node : parts.nodes) {
    writer.put(node.u);
    writer.put(node.v);
    writer.put(node.w);
    writer.put(node.gain);
  }
  writer.put(parts.masks);
  for (const WarpSample& sample : parts.dense) {
    writer.put(sample.u);
    writer.put(sample.v);
    writer.put(sample.gain);
  }
  return writer.take();
}

}  // namespace raysteer::proto::lut
