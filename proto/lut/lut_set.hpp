// value: everything a calibration tells the device: pushed, verified, tried, kept or rolled back as a whole.
//
// docs/lut-format.md has every byte. Equal sets have equal bytes.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"
#include "proto/lut/keep_out.hpp"
#include "proto/lut/steering_table.hpp"
#include "proto/lut/warp_map.hpp"

namespace raysteer::proto::lut {

struct LutSet {
  std::string calibration_id;  ///< 1 to 64 bytes
  std::string board_id;        ///< 1 to 64 bytes; a device refuses another board's tables
  SteeringTable steering;
  std::vector<KeepOut> keep_out;
  std::vector<WarpMap> maps;  ///< no two of one name

  /// The map of a station, or none.
  const WarpMap* find(std::string_view name) const;
  /// The command that aims at a place; nothing where the mirror does not reach or a zone forbids light.
  std::optional<MirrorCommand> aim(const PlanePoint& place) const;
  bool operator==(const LutSet&) const = default;
};

/// Errors: kTableDamaged (names too long or doubled, more than a file may hold).
Result<std::vector<std::uint8_t>> write_lut_set(const LutSet& set);

/// Errors: kTableDamaged (not a LUT set, cut off, changed, numbers out of range), kTableVersion. Allocates at most a
/// small multiple of `bytes`.
Result<LutSet> read_lut_set(std::span<const std::uint8_t> bytes);

/// Name of bytes by their content: SHA-256 in lower-case hexadecimal digits.
std::string object_id(std::span<const std::uint8_t> bytes);

}  // namespace raysteer::proto::lut
