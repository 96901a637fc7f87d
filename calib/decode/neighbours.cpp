#include "calib/decode/neighbours.hpp"

#include <array>
#include <vector>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// Codes further apart than `reach` set `apart`.
[[gnu::always_inline]] inline void compare(const std::uint16_t* __restrict here, const std::uint16_t* __restrict there,
                                           std::uint16_t reach, int count, std::uint8_t* __restrict apart) {
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const std::uint16_t higher = here[i] > there[i] ? here[i] : there[i];
    const std::uint16_t lower = here[i] > there[i] ? there[i] : here[i];
    const bool far = static_cast<std::uint16_t>(higher - lower) > reach;
    apart[i] = static_cast<std::uint8_t>(apart[i] | (far ? 1U : 0U));
  }
}

RAYSTEER_CLONES void count_agreeing(const std::array<const std::uint16_t*, 3>& x,
                                    const std::array<const std::uint16_t*, 3>& y,
                                    const std::array<const std::uint8_t*, 3>& mask, std::uint16_t reach_x,
                                    std::uint16_t reach_y, int count, std::uint8_t* __restrict agreeing,
                                    std::uint8_t* __restrict apart) {
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    agreeing[i] = 0;
  }
  for (int row = 0; row < 3; ++row) {
    if (mask[row] == nullptr) {
      continue;
    }
    for (int shift = -1; shift <= 1; ++shift) {
      if (row == 1 && shift == 0) {
        continue;
      }
      const int first = shift < 0 ? 1 : 0;
      const int inner = count - (shift != 0 ? 1 : 0);
      const std::uint8_t* __restrict valid = mask[row] + first + shift;
      RAYSTEER_INDEPENDENT
      for (int i = 0; i < inner; ++i) {
        apart[i] = valid[i] != 0 ? 1 : 0;
      }
      if (x[1] != nullptr) {
        compare(x[1] + first, x[row] + first + shift, reach_x, inner, apart);
      }
      if (y[1] != nullptr) {
        compare(y[1] + first, y[row] + first + shift, reach_y, inner, apart);
      }
      std::uint8_t* __restrict sum = agreeing + first;
      RAYSTEER_INDEPENDENT
      for (int i = 0; i < inner; ++i) {
        sum[i] = static_cast<std::uint8_t>(sum[i] + (apart[i] ^ 1U));
      }
    }
  }
}

}  // namespace

void mark_edges(CodeMap& map, int reach_x, int reach_y, int fewest) {
  const int width = map.mask.width();
  const int height = map.mask.height();
  std::vector<std::uint8_t> apart(static_cast<std::size_t>(width));
  // Marks of a row are written one row later, so that each pixel is judged by the masks before any mark.
  std::array<std::vector<std::uint8_t>, 2> agreeing;
  agreeing[0].resize(static_cast<std::size_t>(width));
  agreeing[1].resize(static_cast<std::size_t>(width));
  const auto write = [&](int v) {
    std::uint8_t* mask = map.mask.row(v);
    const std::uint8_t* counts = agreeing[v % 2].data();
    for (int u = 0; u < width; ++u) {
      mask[u] = mask[u] == kValid && counts[u] < fewest ? std::uint8_t{kEdge} : mask[u];
    }
  };
  for (int v = 0; v < height; ++v) {
    std::array<const std::uint16_t*, 3> x{}, y{};
    std::array<const std::uint8_t*, 3> mask{};
    for (int k = 0; k < 3; ++k) {
      const int row = v - 1 + k;
      if (row >= 0 && row < height) {
        mask[k] = map.mask.row(row);
        x[k] = map.code_x.empty() ? nullptr : map.code_x.row(row);
        y[k] = map.code_y.empty() ? nullptr : map.code_y.row(row);
      }
    }
    count_agreeing(x, y, mask, static_cast<std::uint16_t>(reach_x), static_cast<std::uint16_t>(reach_y), width,
                   agreeing[v % 2].data(), apart.data());
    if (v > 0) {
      write(v - 1);
    }
  }
  write(height - 1);
}

}  // namespace raysteer::calib::decode
