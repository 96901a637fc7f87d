// value: named places to augment and places to keep dark ("stations.toml", docs/stations-format.md). Positions are in
// the room's frame, which the datums define.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::proto::stations {

using Vec3 = std::array<double, 3>;

/// What the picture lies on: the station's own plane, or the scanned surface that it is draped on, seen along the
/// station's -z.
enum class Surface { kPlane, kScan };

/// A picture's place. Its frame: origin in the middle, x to the picture's right, y to its top, z out of the surface.
/// Unturned on a floor, x and y are the room's.
struct Station {
  std::string name;                ///< unique; part of file names
  Vec3 position_m{};               ///< of the middle, the room's frame
  Vec3 rotation_deg{};             ///< rotation vector R_room_station; [0, 0, turn] on a floor
  std::array<double, 2> size_m{};  ///< width, height
  Surface surface = Surface::kPlane;
  std::string content;        ///< picture file beside this one or below; empty: the test card
  double tolerance_mm = 0;    ///< what the 95 % upper bound of any corner's error is compared with
  std::optional<Vec3> eye_m;  ///< drawn so that it looks right from here, the room's frame
  bool operator==(const Station&) const = default;
};

/// An area that no light may reach: the polygon, and all that is seen through it from the projector.
struct KeepOut {
  std::string name;
  std::vector<Vec3> corners_m;  ///< at least three, the room's frame; their outline does not cross itself
  bool operator==(const KeepOut&) const = default;
};

struct Stations {
  std::string name;
  std::vector<Station> stations;  ///< at least one
  std::vector<KeepOut> keep_out;
  bool operator==(const Stations&) const = default;

  /// kStationUnknown lists the names there are.
  Result<const Station*> find(std::string_view station) const;
};

/// Reads stations. Errors name file, line and what was expected: kTomlSyntax, kFormatVersion, kUnknownKey, kMissingKey,
/// kBadValue, kPathOutside (content that is not beside the file or below).
Result<Stations> read_stations(std::string_view text, const std::string& file);

/// The text of stations: read_stations() gives the same value.
std::string write_stations(const Stations& stations);

}  // namespace raysteer::proto::stations
