#include "calib/decode/neighbours.hpp"

#include <array>
#include <limits>

#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// Codes of three rows of one axis; a row outside the image, or an axis that is not coded, is null.
using Rows = std::array<const std::uint16_t*, 3>;

/// 1 if the codes differ by no more than `reach`. In 16 bits, for the vectoriser.
[[gnu::always_inline]] inline std::uint16_t near(std::uint16_t a, std::uint16_t b, std::uint16_t reach) {
  const std::uint16_t high = a > b ? a : b;
  const std::uint16_t low = a > b ? b : a;
  return static_cast<std::uint16_t>(high - low) <= reach ? std::uint16_t{1} : std::uint16_t{0};
}

struct Counts {
  int valid = 0, saturated = 0, covered = 0;
};

/// Judges pixels `first` to `last` - 1, all of which have neighbours on both sides. One pass: how many agree is never
/// stored. A pixel without code has a reason already, so what it is near to does not matter.
template <bool kX, bool kY>
[[gnu::always_inline]] inline void judge(const Rows& x, const Rows& y, const Resemblance& like, int first, int last,
                                         std::uint8_t* __restrict mask) {
  const auto reach_x = static_cast<std::uint16_t>(like.reach_x);
  const auto reach_y = static_cast<std::uint16_t>(like.reach_y);
  const auto fewest = static_cast<std::uint16_t>(like.fewest);
  const std::uint16_t* __restrict x0 = x[0];
  const std::uint16_t* __restrict x1 = x[1];
  const std::uint16_t* __restrict x2 = x[2];
  const std::uint16_t* __restrict y0 = y[0];
  const std::uint16_t* __restrict y1 = y[1];
  const std::uint16_t* __restrict y2 = y[2];
  RAYSTEER_INDEPENDENT
  for (int i = first; i < last; ++i) {
    const auto agrees = [&](const std::uint16_t* __restrict x_there, const std::uint16_t* __restrict y_there, int at) {
      std::uint16_t both = 1;
      if constexpr (kX) {
        both = near(x1[i], x_there[at], reach_x);
      }
      if constexpr (kY) {
        both = both & near(y1[i], y_there[at], reach_y);
      }
      return both;
    };
    const auto agreeing = static_cast<std::uint16_t>(agrees(x0, y0, i - 1) + agrees(x0, y0, i) + agrees(x0, y0, i + 1) +
                                                     agrees(x1, y1, i - 1) + agrees(x1, y1, i + 1) +
                                                     agrees(x2, y2, i - 1) + agrees(x2, y2, i) + agrees(x2, y2, i + 1));
    const std::uint16_t before = mask[i];
    const std::uint16_t lonely = agreeing < fewest ? std::uint16_t{kEdge} : std::uint16_t{0};
    mask[i] = static_cast<std::uint8_t>(before == 0 ? lonely : before);
  }
}

RAYSTEER_CLONES void judge_row(const Rows& x, const Rows& y, const Resemblance& like, int first, int last,
                               std::uint8_t* mask) {
  if (x[1] == nullptr) {
    judge<false, true>(x, y, like, first, last, mask);
  } else if (y[1] == nullptr) {
    judge<true, false>(x, y, like, first, last, mask);
  } else {
    judge<true, true>(x, y, like, first, last, mask);
  }
}

RAYSTEER_CLONES void count_reasons(const std::uint8_t* __restrict mask, int count, Counts& counts) {
  // Bytes hold the counts of 255 turns, and as many lanes a register as there are.
  constexpr int kPiece = 128;
  counts = {};
  for (int first = 0; first < count; first += kPiece) {
    const int last = count < first + kPiece ? count : first + kPiece;
    std::uint8_t valid = 0, saturated = 0, covered = 0;
    for (int i = first; i < last; ++i) {
      const std::uint8_t reasons = mask[i];
      valid = static_cast<std::uint8_t>(valid + (reasons == 0 ? 1 : 0));
      saturated = static_cast<std::uint8_t>(saturated + ((reasons & kSaturated) != 0 ? 1 : 0));
      covered = static_cast<std::uint8_t>(covered + ((reasons & (kShadow | kLowModulation | kSaturated)) == 0 ? 1 : 0));
    }
    counts.valid += valid;
    counts.saturated += saturated;
    counts.covered += covered;
  }
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
    : map_(map),
      resemblance_(resemblance),
      nothing_(static_cast<std::size_t>(map.mask.width()), std::uint16_t{CodeMap::kNoCode}) {}

void RowCheck::ask_neighbours(int v) {
  if (resemblance_.fewest == 0) {
    return;
  }
  const int width = map_.mask.width();
  const int height = map_.mask.height();
  Rows x{}, y{};
  for (int k = 0; k < 3; ++k) {
    // Rows outside the image have no codes.
    const int at = v - 1 + k;
    const bool inside = at >= 0 && at < height;
    x[k] = map_.code_x.empty() ? nullptr : inside ? map_.code_x.row(at) : nothing_.data();
    y[k] = map_.code_y.empty() ? nullptr : inside ? map_.code_y.row(at) : nothing_.data();
  }
  std::uint8_t* mask = map_.mask.row(v);
  judge_row(x, y, resemblance_, 1, width - 1, mask);
  // The first and the last pixel of the row have nobody beside them.
  for (const int end : {0, width - 1}) {
    const int inner = end == 0 ? 0 : end - 1;
    std::array<std::array<std::uint16_t, 3>, 6> around;
    Rows x_around{}, y_around{};
    for (std::size_t k = 0; k < 6; ++k) {
      const std::uint16_t* from = k < 3 ? x[k] : y[k - 3];
      if (from == nullptr) {
        continue;
      }
      around[k] = {end == 0 ? CodeMap::kNoCode : from[inner], from[end], end == 0 ? from[1] : CodeMap::kNoCode};
      (k < 3 ? x_around[k] : y_around[k - 3]) = around[k].data();
    }
    std::array<std::uint8_t, 3> reasons{0, mask[end], 0};
    judge_row(x_around, y_around, resemblance_, 1, 2, reasons.data());
    mask[end] = reasons[1];
  }
}

void RowCheck::settle(int v) {
  const int width = map_.mask.width();
  std::uint8_t* mask = map_.mask.row(v);
  Counts counts;
  count_reasons(mask, width, counts);
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
