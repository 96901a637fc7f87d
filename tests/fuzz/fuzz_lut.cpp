// LUT sets from anywhere: refused, or read, looked up and written again to the same bytes. The hashes would keep a
// fuzzer from everything behind them, so the first byte may say that one section comes alone.
#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/base/result.hpp"
#include "proto/lut/evaluate.hpp"
#include "proto/lut/sections.hpp"

namespace {

using namespace raysteer::proto::lut;
using Bytes = std::span<const std::uint8_t>;

void same(const std::vector<std::uint8_t>& written, Bytes bytes) {
  RAYSTEER_CHECK(std::equal(written.begin(), written.end(), bytes.begin(), bytes.end()));
}

void look_up(const WarpMap& map) {
  static WarpTile tile;
  for (int row = 0; row < map.rows(); row += 1 + map.rows() / 8) {
    for (int column = 0; column < map.columns(); column += 1 + map.columns() / 8) {
      evaluate(map, column, row, tile);
      for (int j = 0; j < tile.height && !tile.empty; ++j) {
        for (int i = 0; i < tile.width; ++i) {
          const std::size_t at = WarpTile::at(i, j);
          RAYSTEER_CHECK(tile.u[at] >= -kSubPixel && tile.u[at] <= map.parts().content_width * kSubPixel);
          RAYSTEER_CHECK(tile.v[at] >= -kSubPixel && tile.v[at] <= map.parts().content_height * kSubPixel);
        }
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const Bytes bytes(data + 1, size - 1);
  switch (data[0]) {
    case 1:
      if (const auto identity = read_identity(bytes)) {
        same(write_identity(*identity), bytes);
      }
      break;
    case 2:
      if (const auto table = read_steering(bytes)) {
        same(write_steering(*table), bytes);
        for (double x = -2; x < 2; x += 0.3) {
          (void)table->command({x, 1 - x});
        }
      }
      break;
    case 3:
      if (const auto zones = read_keep_out(bytes)) {
        same(write_keep_out(*zones), bytes);
        for (const KeepOut& zone : *zones) {
          (void)zone.contains({0.5, 0.5});
        }
      }
      break;
    case 4:
      if (const auto map = read_warp_map(bytes)) {
        same(write_warp_map(*map), bytes);
        look_up(*map);
      }
      break;
    default:
      if (const auto set = read_lut_set(bytes)) {
        const auto written = write_lut_set(*set);
        RAYSTEER_CHECK(written.has_value());
        same(*written, bytes);
      }
  }
  return 0;
}
