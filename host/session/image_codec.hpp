// value: image files as grey pixels: PNG, JPEG, PGM, BMP and raw frames in; PNG, PGM and raw out.
//
// The kind is told by the first bytes, never by the file's name. Colour becomes grey by ITU-R BT.601 weights
// (equal channels keep their value exactly). Damaged input is an error, never a guess: kFileTruncated or kFrameFormat.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "proto/session/raw_frame.hpp"

namespace raysteer::host::session {

enum class ImageKind { kUnknown, kPng, kJpeg, kPgm, kBmp, kRaw };

/// What the header says; the pixels may still be damaged.
struct ImageHeader {
  ImageKind kind = ImageKind::kUnknown;
  int width = 0;
  int height = 0;
  int bits = 8;  ///< 8 or 16 per grey pixel
};

/// Refused beyond this: 2^28 pixels, far more than any camera we know has.
inline constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;

/// All threads may call these at once. `bytes` is a whole file.
Result<ImageHeader> read_header(std::span<const std::uint8_t> bytes);
Result<Frame> decode_image(std::span<const std::uint8_t> bytes);
/// Into an image that is reused when its size fits. kFrameDepth when the file has the other depth.
Status decode_image(std::span<const std::uint8_t> bytes, Image<std::uint8_t>& into);
Status decode_image(std::span<const std::uint8_t> bytes, Image<std::uint16_t>& into);

/// Bytes of a grey image. Compression is zlib's fastest for PNG.
Result<std::vector<std::uint8_t>> encode_png(ImageView<const std::uint8_t> pixels);
Result<std::vector<std::uint8_t>> encode_png(ImageView<const std::uint16_t> pixels);
std::vector<std::uint8_t> encode_pgm(ImageView<const std::uint8_t> pixels);
std::vector<std::uint8_t> encode_pgm(ImageView<const std::uint16_t> pixels);

/// Whole files. Errors: kFileMissing, kFileUnreadable; kDiskFull, kWriteFailed (nothing half-written stays).
Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path);
Status write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes);

}  // namespace raysteer::host::session
