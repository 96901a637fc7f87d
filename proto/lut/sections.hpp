// pure: the parts of a LUT set as bytes, without the hashes around them. For the set's reader and writer, and fuzzing.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "proto/lut/lut_set.hpp"

namespace raysteer::proto::lut {

enum class SectionKind : std::uint32_t { kIdentity = 1, kSteering = 2, kKeepOut = 3, kWarpMap = 4 };

inline constexpr std::array<std::uint8_t, 4> kLutMagic{'R', 'L', 'U', 'T'};
inline constexpr std::uint32_t kLutVersion = 1;
inline constexpr std::size_t kHeaderBytes = 12;   ///< before the section table
inline constexpr std::size_t kSectionBytes = 48;  ///< a row of it
inline constexpr std::uint32_t kMostSections = 4096;

struct Identity {
  std::string calibration_id;
  std::string board_id;
};

std::vector<std::uint8_t> write_identity(const Identity& identity);
std::vector<std::uint8_t> write_steering(const SteeringTable& table);
std::vector<std::uint8_t> write_keep_out(std::span<const KeepOut> zones);
std::vector<std::uint8_t> write_warp_map(const WarpMap& map);

// Errors of all: kTableDamaged.
Result<Identity> read_identity(std::span<const std::uint8_t> bytes);
Result<SteeringTable> read_steering(std::span<const std::uint8_t> bytes);
Result<std::vector<KeepOut>> read_keep_out(std::span<const std::uint8_t> bytes);
Result<WarpMap> read_warp_map(std::span<const std::uint8_t> bytes);

}  // namespace raysteer::proto::lut
