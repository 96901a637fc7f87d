// value: a place on a plane -> the mirror command that brings a given panel pixel there. Bytes: docs/lut-format.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::proto::lut {

/// Whose coordinates T_frame_plane gives.
enum class Frame : std::uint8_t {
  kRig = 1,    ///< the left camera's
  kDatums = 2  ///< the room's: of the surveyed targets
};

/// A place in the table's plane, metres.
struct PlanePoint {
  double x = 0;
  double y = 0;

  bool operator==(const PlanePoint&) const = default;
};

/// Of the mirror's two axes, radians.
struct MirrorCommand {
  double axis1_rad = 0;
  double axis2_rad = 0;
};

struct SteeringTableParts {
  Frame frame = Frame::kRig;
  /// The plane: a point (x, y, 0) of it in the frame, rows of a 3x4 matrix, metres.
  std::array<double, 12> T_frame_plane{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  std::array<double, 2> aim_px{};  ///< the panel pixel that is brought to the place
  PlanePoint origin;               ///< of the first node
  double spacing_m = 0;            ///< of nodes, the same both ways
  int columns = 0;                 ///< of nodes, at least 2, along the plane's x
  int rows = 0;
  std::array<std::int32_t, 2> least_nrad{};  ///< commands that the mirror may be given
  std::array<std::int32_t, 2> most_nrad{};
  double bound_m = 0;  ///< the pixel lands no further from the place, by the model the table was baked from
  double worst_m = 0;  ///< of the places tried when baked; at most bound_m
  std::vector<std::array<std::int32_t, 2>> nodes;  ///< commands, nanoradians, row by row along y
  std::vector<std::uint8_t> reached;  ///< of each cell between four nodes, row by row: 1, or 0 where no light comes

  bool operator==(const SteeringTableParts&) const = default;
};

class SteeringTable {
 public:
  static constexpr int kMostNodes = 1 << 22;

  /// Errors: kTableDamaged (sizes that do not fit each other or the limits, numbers out of range).
  static Result<SteeringTable> make(SteeringTableParts parts);

  const SteeringTableParts& parts() const { return parts_; }
  /// Bilinear between nodes. Nothing where no light comes or the command is out of the mirror's range. Never allocates.
  std::optional<MirrorCommand> command(const PlanePoint& place) const;
  bool operator==(const SteeringTable& other) const { return parts_ == other.parts_; }

 private:
  explicit SteeringTable(SteeringTableParts parts) : parts_(std::move(parts)) {}

  SteeringTableParts parts_;
};

}  // namespace raysteer::proto::lut
