#include "calib/decode/sequence_bits.hpp"

#include <gtest/gtest.h>

namespace raysteer::calib::decode {
namespace {

constexpr int kTiles = 40;
constexpr int kSide = 16;
constexpr int kApart = 64;  // px from tile to tile
constexpr int kStripe = 4;  // px
constexpr int kBits = 10;

unsigned gray(int row) {
  const auto code = static_cast<unsigned>(row / kStripe);
  return code ^ (code >> 1U);
}

/// Tiles over a picture of stripes along y, the first row of pixels at `first`; what bit k shows is `shown(k, row)`.
template <class Shown>
std::vector<BitReading> readings(int first, Shown shown) {
  std::vector<BitReading> all(kBits);
  for (int k = 0; k < kBits; ++k) {
    for (int tile = 0; tile < kTiles * kTiles; ++tile) {
      for (int i = 0; i < kSide * kSide; ++i) {
        const int row = first + tile / kTiles * kApart + i / kSide;
        all[static_cast<std::size_t>(k)].side.push_back(shown(k, row));
      }
    }
    all[static_cast<std::size_t>(k)].sure = all[static_cast<std::size_t>(k)].side;
  }
  return all;
}

std::uint8_t as_it_is(int k, int row) { return (gray(row) >> static_cast<unsigned>(k)) & 1U; }

BitVerdict verdict(const std::vector<BitReading>& bits) {
  return judge(count_bits(bits, kSide, kTiles * kApart / kStripe));
}

// Bit 3 changes every 64 px, as far as tiles are apart, and never within one; bit 4 changes within every second tile.
TEST(SequenceBits, edges_that_all_run_between_the_tiles_are_no_fault) {
  const auto bits = readings(kApart - kSide / 2, as_it_is);
  const BitTable table = count_bits(bits, kSide, kTiles * kApart / kStripe);
  ASSERT_EQ(table.changes[3], 0);
  ASSERT_GT(table.changes[4], 10'000);
  EXPECT_TRUE(judge(table).good());
}

TEST(SequenceBits, a_coarse_bit_that_shows_other_stripes_is_a_fault_there_too) {
  const auto other = readings(kApart - kSide / 2, [](int k, int row) -> std::uint8_t {
    return k == 6 ? static_cast<std::uint8_t>(row / 7 % 2) : as_it_is(k, row);
  });
  EXPECT_FALSE(verdict(other).good());
  const auto twice = readings(kApart - kSide / 2, [](int k, int row) { return as_it_is(k == 6 ? 4 : k, row); });
  EXPECT_FALSE(verdict(twice).good());
}

}  // namespace
}  // namespace raysteer::calib::decode
