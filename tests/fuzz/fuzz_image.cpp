// Image files from anywhere: decoded or refused, in either depth.
#include <cstddef>
#include <cstdint>
#include <variant>

#include "hal/base/result.hpp"
#include "host/session/image_codec.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace raysteer;
  using namespace raysteer::host::session;
  const Result<ImageHeader> header = read_header({data, size});
  // Large pictures only make the fuzzer slow.
  constexpr std::int64_t kMostTried = 1 << 20;
  if (!header || std::int64_t{header->width} * header->height > kMostTried) {
    return 0;
  }
  if (const Result<Frame> frame = decode_image({data, size})) {
    const int width = std::visit([](const auto& image) { return image.width(); }, *frame);
    RAYSTEER_CHECK(width == header->width);
    RAYSTEER_CHECK(std::holds_alternative<Image<std::uint8_t>>(*frame) == (header->bits == 8));
  }
  return 0;
}
