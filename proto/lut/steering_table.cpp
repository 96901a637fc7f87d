#include "proto/lut/steering_table.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace raysteer::proto::lut {
namespace {

bool within(double value, double least, double most) { return value >= least && value <= most; }  // false for NaN

constexpr double kFarthest = 1e6;  // metres and pixels: more is damage

}  // namespace

Result<SteeringTable> SteeringTable::make(SteeringTableParts parts) {
  const auto damaged = [](const std::string& what) {
    return fail(RCode::kTableDamaged, "the steering table's " + what + " out of range or do not fit");
  };
  if (parts.frame != Frame::kRig && parts.frame != Frame::kDatums) {
    return damaged("frame is");
  }
  const auto near = [](double value) { return within(value, -kFarthest, kFarthest); };
  if (!std::ranges::all_of(parts.T_frame_plane, near) || !std::ranges::all_of(parts.aim_px, near) ||
      !near(parts.origin.x) || !near(parts.origin.y) || !within(parts.spacing_m, 1e-6, kFarthest) ||
      !within(parts.bound_m, 0, kFarthest) || !within(parts.worst_m, 0, parts.bound_m)) {
    return damaged("numbers are");
  }
  if (parts.columns < 2 || parts.rows < 2 || std::int64_t{parts.columns} * parts.rows > kMostNodes ||
      parts.nodes.size() != static_cast<std::size_t>(parts.columns) * static_cast<std::size_t>(parts.rows)) {
    return damaged("nodes are");
  }
  if (parts.reached.size() != static_cast<std::size_t>(parts.columns - 1) * static_cast<std::size_t>(parts.rows - 1) ||
      std::ranges::any_of(parts.reached, [](std::uint8_t reached) { return reached > 1; })) {
    return damaged("cells are");
  }
  return SteeringTable(std::move(parts));
}

std::optional<MirrorCommand> SteeringTable::command(const PlanePoint& place) const {
  const double x = (place.x - parts_.origin.x) / parts_.spacing_m;
  const double y = (place.y - parts_.origin.y) / parts_.spacing_m;
  if (!within(x, 0, parts_.columns - 1) || !within(y, 0, parts_.rows - 1)) {
    return std::nullopt;
  }
  const int column = std::min(static_cast<int>(x), parts_.columns - 2);
  const int row = std::min(static_cast<int>(y), parts_.rows - 2);
  if (parts_.reached[static_cast<std::size_t>(row) * static_cast<std::size_t>(parts_.columns - 1) +
                     static_cast<std::size_t>(column)] == 0) {
    return std::nullopt;
  }
  const double right = x - column;
  const double down = y - row;
  const auto* top = &parts_.nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(parts_.columns) +
                                  static_cast<std::size_t>(column)];
  const auto* bottom = top + parts_.columns;
  std::array<double, 2> command{};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double nrad = (1 - down) * ((1 - right) * top[0][axis] + right * top[1][axis]) +
                        down * ((1 - right) * bottom[0][axis] + right * bottom[1][axis]);
    if (!within(nrad, parts_.least_nrad[axis], parts_.most_nrad[axis])) {
      return std::nullopt;
    }
    command[axis] = 1e-9 * nrad;
  }
  return MirrorCommand{.axis1_rad = command[0], .axis2_rad = command[1]};
}

}  // namespace raysteer::proto::lut
