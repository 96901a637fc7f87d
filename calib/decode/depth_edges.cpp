#include "calib/decode/depth_edges.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "calib/decode/vectorise.hpp"

namespace raysteer::calib::decode {
namespace {

/// A bend is x0 - 2 x1 + x2, of a pixel and the next two in a direction. On a surface it is the surface's curvature.
constexpr float kStraightPx = 0.5F;
constexpr float kStraightSigma = 2;

/// Pixels that a bend looks at on either side.
constexpr int kReach = 2;
constexpr int kRows = 2 * kReach + 1;

/// Five rows around one, with kReach pixels more on either side; [kReach] is the row itself.
struct Around {
  std::array<const float*, kRows> value;
  std::array<const float*, kRows> variance;
};

/// Bit k of `straight` stays where direction k is straight along this axis, too.
RAYSTEER_CLONES void keep_straight(const Around& around, int count, std::int32_t* __restrict straight) {
  const auto row = [](const std::array<const float*, kRows>& rows, int k) { return rows[static_cast<std::size_t>(k)]; };
  const auto bit = [&](int i, int down, int right, int direction) {
    const float* at = row(around.value, kReach) + i;
    const float* next = row(around.value, kReach + down) + i + right;
    const float* far = row(around.value, kReach + 2 * down) + i + 2 * right;
    const float* at_variance = row(around.variance, kReach) + i;
    const float* next_variance = row(around.variance, kReach + down) + i + right;
    const float* far_variance = row(around.variance, kReach + 2 * down) + i + 2 * right;
    const float bend = *at - 2 * *next + *far;
    const float limit = kStraightPx * kStraightPx +
                        kStraightSigma * kStraightSigma * (*at_variance + 4 * *next_variance + *far_variance);
    return bend * bend < limit ? 1 << direction : 0;
  };
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    straight[i] &= bit(i, 0, 1, 0) | bit(i, 1, 1, 1) | bit(i, 1, 0, 2) | bit(i, 1, -1, 3) | bit(i, 0, -1, 4) |
                   bit(i, -1, -1, 5) | bit(i, -1, 0, 6) | bit(i, -1, 1, 7);
  }
}

constexpr std::int32_t kAllDirections = 0xff;

RAYSTEER_CLONES void judge(const std::int32_t* __restrict straight, int count, std::uint8_t* __restrict mask) {
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    const std::int32_t round = straight[i] | straight[i] << 8;
    const std::int32_t three = round & round >> 1 & round >> 2 & kAllDirections;
    mask[i] = mask[i] == 0 && three == 0 ? std::uint8_t{kEdge} : mask[i];
  }
}

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

RAYSTEER_CLONES void copy_valid(const float* __restrict from, const std::uint8_t* __restrict mask, int count,
                                float* __restrict to) {
  RAYSTEER_INDEPENDENT
  for (int i = 0; i < count; ++i) {
    to[i] = mask[i] == 0 ? from[i] : kNothing;
  }
}

/// The last five rows of an image, in a ring.
class Ring {
 public:
  explicit Ring(const Image<float>& image)
      : image_(&image),
        stride_(image.width() + 2 * kReach),
        rows_(static_cast<std::size_t>(kRows) * static_cast<std::size_t>(stride_), kNothing) {}

  /// Row v of the image where `mask` is 0; NaN elsewhere, and below the image.
  void take(int v, const Image<std::uint8_t>& mask) {
    float* row = at(v);
    if (v < image_->height()) {
      copy_valid(image_->row(v), mask.row(v), image_->width(), row);
    } else {
      std::fill(row, row + image_->width(), kNothing);
    }
  }
  std::array<const float*, kRows> around(int v) {
    std::array<const float*, kRows> rows;
    for (int k = 0; k < kRows; ++k) {
      rows[static_cast<std::size_t>(k)] = at(v - kReach + k);
    }
    return rows;
  }

 private:
  float* at(int v) { return rows_.data() + static_cast<std::ptrdiff_t>((v + kRows) % kRows) * stride_ + kReach; }

  const Image<float>* image_;
  int stride_;
  std::vector<float> rows_;
};

}  // namespace

void mark_depth_edges(std::span<const Placed> axes, Image<std::uint8_t>& mask) {
  struct Rings {
    Ring value, variance;
  };
  std::vector<Rings> rings;
  for (const Placed& axis : axes) {
    rings.push_back({Ring(*axis.value), Ring(*axis.variance)});
  }
  const auto take = [&](int v) {
    for (Rings& ring : rings) {
      ring.value.take(v, mask);
      ring.variance.take(v, mask);
    }
  };
  for (int v = 0; v < kReach; ++v) {
    take(v);
  }
  std::vector<std::int32_t> straight(static_cast<std::size_t>(mask.width()));
  for (int v = 0; v < mask.height(); ++v) {
    take(v + kReach);
    std::ranges::fill(straight, kAllDirections);
    for (Rings& ring : rings) {
      keep_straight({ring.value.around(v), ring.variance.around(v)}, mask.width(), straight.data());
    }
    judge(straight.data(), mask.width(), mask.row(v));
  }
}

}  // namespace raysteer::calib::decode
