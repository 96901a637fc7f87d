#include "calib/decode/neighbours.hpp"

#include <array>
#include <limits>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// Codes of three rows of one axis; a row outside the image, or an axis that is not coded, is null.
using Rows = std::array<const std::uint16_t*, 3>;

[[gnu::always_inline]] inline std::uint16_t near(std::uint16_t a, std::uint16_t b, std::uint16_t reach) {
  const std::uint16_t above = a > b ? static_cast<std::uint16_t>(a - b) : std::uint16_t{0};
  const std::uint16_t below = b > a ? static_cast<std::uint16_t>(b - a) : std::uint16_t{0};
  return static_cast<std::uint16_t>(above + below) <= reach ? std::uint16_t{1} : std::uint16_t{0};
}

/// Adds neighbour `shift` in row `k` of each pixel from `first` on. A neighbour without code is not near any code.
[[gnu::always_inline]] inline void add_neighbour(const Rows& x, const Rows& y, const Resemblance& like, int k,
                                                 int shift, int first, int last, std::uint16_t* __restrict agreeing) {
  const auto reach_x = static_cast<std::uint16_t>(like.reach_x);
  const auto reach_y = static_cast<std::uint16_t>(like.reach_y);
  const std::uint16_t* __restrict x_here = x[1];
  const std::uint16_t* __restrict x_there = x[k] + shift;
  const std::uint16_t* __restrict y_here = y[1];
  const std::uint16_t* __restrict y_there = y[k] + shift;
  if (x_here != nullptr && y_here != nullptr) {
    RAYSTEER_INDEPENDENT
    for (int i = first; i < last; ++i) {
      const std::uint16_t both = near(x_here[i], x_there[i], reach_x) & near(y_here[i], y_there[i], reach_y);
      agreeing[i] = static_cast<std::uint16_t>(agreeing[i] + both);
    }
    return;
  }
  const std::uint16_t* __restrict here = x_here != nullptr ? x_here : y_here;
  const std::uint16_t* __restrict there = x_here != nullptr ? x_there : y_there;
  const std::uint16_t reach = x_here != nullptr ? reach_x : reach_y;
  RAYSTEER_INDEPENDENT
  for (int i = first; i < last; ++i) {
    agreeing[i] = static_cast<std::uint16_t>(agreeing[i] + near(here[i], there[i], reach));
  }
}

RAYSTEER_CLONES void count_agreeing(const Rows& x, const Rows& y, const Resemblance& like, int count,
                                    std::uint16_t* agreeing) {
  for (int i = 0; i < count; ++i) {
    agreeing[i] = 0;
  }
  const Rows& any = x[1] != nullptr ? x : y;
  for (int k = 0; k < 3; ++k) {
    if (any[k] == nullptr) {
      continue;
    }
    add_neighbour(x, y, like, k, -1, 1, count, agreeing);
    add_neighbour(x, y, like, k, 1, 0, count - 1, agreeing);
    if (k != 1) {
      add_neighbour(x, y, like, k, 0, 0, count, agreeing);
    }
  }
}

struct Counts {
  int valid = 0, saturated = 0, covered = 0;
};

RAYSTEER_CLONES void mark(const std::uint16_t* __restrict agreeing, std::uint16_t fewest, int count,
                          std::uint8_t* __restrict mask, Counts& counts) {
  // A row has at most 32768 pixels: 16 bits hold the counts, and twice as many lanes a register.
  using Count = std::uint16_t;
  Count valid = 0, saturated = 0, covered = 0;
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const Count before = mask[i];
    const Count lonely = agreeing[i] < fewest ? Count{kEdge} : Count{0};
    const Count after = before == 0 ? lonely : before;
    mask[i] = static_cast<std::uint8_t>(after);
    valid = static_cast<Count>(valid + (after == 0 ? 1 : 0));
    saturated = static_cast<Count>(saturated + ((after & kSaturated) != 0 ? 1 : 0));
    covered = static_cast<Count>(covered + ((after & (kShadow | kLowModulation | kSaturated)) == 0 ? 1 : 0));
  }
  counts = {valid, saturated, covered};
}

RAYSTEER_CLONES void blank(const std::uint8_t* __restrict mask, int count, float* __restrict pixels) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    pixels[i] = mask[i] == 0 ? pixels[i] : kNan;
  }
}

}  // namespace

RowCheck::RowCheck(CodeMap& map, const Resemblance& resemblance)
    : map_(map), resemblance_(resemblance), agreeing_(static_cast<std::size_t>(map.mask.width())) {}

void RowCheck::row(int v) {
  const int width = map_.mask.width();
  const int height = map_.mask.height();
  if (resemblance_.fewest > 0) {
    Rows x{}, y{};
    for (int k = 0; k < 3; ++k) {
      const int at = v - 1 + k;
      if (at >= 0 && at < height) {
        x[k] = map_.code_x.empty() ? nullptr : map_.code_x.row(at);
        y[k] = map_.code_y.empty() ? nullptr : map_.code_y.row(at);
      }
    }
    count_agreeing(x, y, resemblance_, width, agreeing_.data());
  }
  std::uint8_t* mask = map_.mask.row(v);
  Counts counts;
  mark(agreeing_.data(), static_cast<std::uint16_t>(resemblance_.fewest), width, mask, counts);
  valid_ += static_cast<std::size_t>(counts.valid);
  saturated_ += static_cast<std::size_t>(counts.saturated);
  covered_ += static_cast<std::size_t>(counts.covered);
  for (Image<float>* image : {&map_.x, &map_.y, &map_.variance_x, &map_.variance_y}) {
    if (!image->empty()) {
      blank(mask, width, image->row(v));
    }
  }
}

}  // namespace raysteer::calib::decode
