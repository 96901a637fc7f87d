// value: the codecs behind image_codec.hpp, one source file each. Private to this folder.
#pragma once

#include <cstdint>
#include <span>
#include <variant>

#include "host/session/image_codec.hpp"

namespace raysteer::host::session {

using Bytes = std::span<const std::uint8_t>;

/// Where the pixels go, without gaps; the depth and the room are those of the header.
using Pixels = std::variant<std::uint8_t*, std::uint16_t*>;

// Headers are read without trust: sizes may still be zero or huge. Decoders get a header that was checked.
Result<ImageHeader> read_png_header(Bytes bytes);
Result<ImageHeader> read_jpeg_header(Bytes bytes);
Result<ImageHeader> read_pgm_header(Bytes bytes);
Result<ImageHeader> read_bmp_header(Bytes bytes);
Result<ImageHeader> read_raw_header(Bytes bytes);

Status decode_png(Bytes bytes, const ImageHeader& header, const Pixels& into);
Status decode_jpeg(Bytes bytes, const ImageHeader& header, const Pixels& into);
Status decode_pgm(Bytes bytes, const ImageHeader& header, const Pixels& into);
Status decode_bmp(Bytes bytes, const ImageHeader& header, const Pixels& into);

/// Grey by the weights of ITU-R BT.601 in 1/256; they add up to 256, so that equal channels keep their value.
constexpr unsigned grey(unsigned red, unsigned green, unsigned blue) {
  return (77 * red + 150 * green + 29 * blue + 128) >> 8U;
}

}  // namespace raysteer::host::session
