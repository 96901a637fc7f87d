// value: the smallest file a camera frame fits in: 16 bytes, then pixels (docs/session-format.md, "Raw frames").
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/base/frame.hpp"
#include "hal/base/result.hpp"

namespace raysteer::proto::session {

/// Files begin with these bytes.
inline constexpr std::uint8_t kRawMagic[4] = {'R', 'S', 'F', '1'};
inline constexpr std::size_t kRawHeaderBytes = 16;

/// The bytes before the pixels. Sides are 1 to 65535, bits 8 or 16. For writers that do not copy pixels.
std::array<std::uint8_t, kRawHeaderBytes> raw_header(int width, int height, int bits);

/// Bytes of a raw frame. Sizes are those of the view; both sides must be 1 to 65535.
std::vector<std::uint8_t> write_raw_frame(ImageView<const std::uint8_t> pixels);
std::vector<std::uint8_t> write_raw_frame(ImageView<const std::uint16_t> pixels);

/// Errors: kFrameFormat (not a raw frame, or bytes left over), kFileTruncated. Allocates only what the bytes fill.
Result<Frame> read_raw_frame(std::span<const std::uint8_t> bytes);

}  // namespace raysteer::proto::session
