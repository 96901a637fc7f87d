// Session files and raw frames from anywhere: read, and if they read, written and read again to the same value.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "hal/base/result.hpp"
#include "proto/session/manifest.hpp"
#include "proto/session/raw_frame.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace raysteer;
  using namespace raysteer::proto::session;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  // An include gets the text itself, without its own includes' ends: circles and depth are found, nothing is read.
  const Loader load = [&](const std::string&) -> Result<std::string> { return std::string(text); };
  if (const Result<Manifest> manifest = read_manifest(text, "fuzz.toml", load)) {
    const Result<Manifest> again = read_manifest(write_manifest(*manifest), "again.toml", load);
    RAYSTEER_CHECK(again && *again == *manifest);
  }
  if (const Result<Frame> frame = read_raw_frame({data, size})) {
    RAYSTEER_CHECK(std::visit([](const auto& image) { return write_raw_frame(image.view()); }, *frame).size() == size);
  }
  return 0;
}
