#include <turbojpeg.h>

#include <memory>
#include <string>

#include "host/session/codec.hpp"

namespace raysteer::host::session {
namespace {

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Decompressor = std::unique_ptr<void, Destroy>;

// libjpeg fills a file that ends too early with grey and calls that a warning.
Error jpeg_error(const Decompressor& handle) {
  const std::string message = tjGetErrorStr2(handle.get());
  const bool ends_early = message.find("Premature end") != std::string::npos;
  return fail(ends_early ? RCode::kFileTruncated : RCode::kFrameFormat, "JPEG: " + message);
}

Result<ImageHeader> header_of(const Decompressor& handle, Bytes bytes) {
  if (handle == nullptr) {
    return fail(RCode::kFrameFormat, "JPEG: no decoder");
  }
  ImageHeader header{.kind = ImageKind::kJpeg, .bits = 8};
  int subsampling = 0;
  int colours = 0;
  if (tjDecompressHeader3(handle.get(), bytes.data(), bytes.size(), &header.width, &header.height, &subsampling,
                          &colours) != 0) {
    return jpeg_error(handle);
  }
  return header;
}

// The last marker of a whole file; encoders may pad behind it.
bool ends_with_marker(Bytes bytes) {
  constexpr std::size_t kMostPadding = 4096;
  std::size_t end = bytes.size();
  while (end > 2 && bytes.size() - end < kMostPadding && bytes[end - 1] == 0) {
    --end;
  }
  return end >= 2 && bytes[end - 2] == 0xff && bytes[end - 1] == 0xd9;
}

}  // namespace

Result<ImageHeader> read_jpeg_header(Bytes bytes) {
  const Decompressor handle(tjInitDecompress());
  Result<ImageHeader> header = header_of(handle, bytes);
  if (!header && !ends_with_marker(bytes)) {
    return fail(RCode::kFileTruncated, header.error().note);
  }
  return header;
}

Status decode_jpeg(Bytes bytes, const ImageHeader& header, const Pixels& into) {
  if (!ends_with_marker(bytes)) {
    return fail(RCode::kFileTruncated, "JPEG: no end-of-image marker");
  }
  const Decompressor handle(tjInitDecompress());
  const Result<ImageHeader> again = header_of(handle, bytes);
  if (!again) {
    return again.error();
  }
  auto* pixels = std::get<std::uint8_t*>(into);
  // Luma is BT.601 already (JFIF). A warning comes back as failure, too. Progressive files of many scans decode
  // slowly without bound; TJFLAG_LIMITSCANS stops at 500.
  if (tjDecompress2(handle.get(), bytes.data(), bytes.size(), pixels, header.width, 0, header.height, TJPF_GRAY,
                    TJFLAG_LIMITSCANS) != 0) {
    return jpeg_error(handle);
  }
  return ok();
}

}  // namespace raysteer::host::session
