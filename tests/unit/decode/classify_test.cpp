#include "calib/decode/classify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "calib/decode/gray_sums.hpp"

namespace raysteer::calib::decode {
namespace {

struct Classified {
  std::vector<std::uint16_t> code;
  std::vector<std::uint8_t> mask;
  std::vector<float> variance;
  bool operator==(const Classified&) const = default;
};

/// Sums of one row with few different levels, so that equal and just different ones occur, and its references.
struct RandomRow {
  static constexpr int kWidth = 4099;  // not a multiple of any register's lanes
  std::array<std::vector<std::uint8_t>, 12> planes;

  explicit RandomRow(unsigned seed) {
    std::mt19937 random(seed);
    for (std::size_t k = 0; k < planes.size(); ++k) {
      planes[k].resize(kWidth);
      for (std::uint8_t& value : planes[k]) {
        const bool small = random() % 2 == 0;
        value = static_cast<std::uint8_t>(small ? random() % 24 : random() % 256);
        if (k == 4) {
          value = static_cast<std::uint8_t>(1U << random() % 8);
        }
      }
    }
  }

  Classified classify_pieces(int piece, GrayLimits limits, bool references) {
    Classified result{std::vector<std::uint16_t>(kWidth), std::vector<std::uint8_t>(kWidth, kEdge),
                      std::vector<float>(kWidth)};
    for (int first = 0; first < kWidth; first += piece) {
      const auto at = [&](std::size_t k) { return planes[k].data() + first; };
      limits.width = std::min(piece, kWidth - first);
      classify(GraySums<std::uint8_t>{at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9)},
               references ? at(10) : nullptr, references ? at(11) : nullptr, limits, result.code.data() + first,
               result.mask.data() + first, result.variance.data() + first);
    }
    return result;
  }
};

TEST(Classify, a_row_is_classified_as_each_of_its_pixels_by_itself) {
  // Single pixels fill no register, so the portable loop does them on every processor.
  const GrayLimits usual{.difference_floor = 5.3F, .difference_slope = 0.0251F, .min_contrast = 12.5F, .codes = 60000};
  GrayLimits coarse = usual;
  coarse.coarse = true;
  coarse.codes = 65536;
  GrayLimits strict = coarse;
  strict.min_difference2 = 65024.5F;
  strict.saturation = 1e9F;
  for (const unsigned seed : {1U, 2U}) {
    for (const GrayLimits& limits : {usual, coarse, strict}) {
      for (const bool references : {true, false}) {
        RandomRow row(seed);
        EXPECT_EQ(row.classify_pieces(RandomRow::kWidth, limits, references),
                  row.classify_pieces(1, limits, references))
            << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace raysteer::calib::decode
