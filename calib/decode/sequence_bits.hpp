// value: do the bits of a Gray code fit each other? Private to the sequence check.
//
// Where one bit of a Gray code changes between neighbouring pixels, and no other does, the next finer bit is 1 there
// and all still finer ones are 0: the code counts up through ..0100.. and ..1100... A table of what each bit reads at
// the edges of each other one therefore tells frames that were exchanged, and bits whose inverse was exchanged with
// the pattern, without knowing anything of the scene. (The most significant bit has no coarser one that could check
// it: complementing it mirrors the code, which is a picture as good as the other.)
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace raysteer::calib::decode {

constexpr std::uint8_t kUndecided = 2;

/// What was counted of one Gray block. Bits are numbered as in Pattern: 0 is the least significant.
struct BitTable {
  static constexpr int kMostBits = 16;
  int bits = 0;
  int finest = 0;                        ///< the finest bit that is resolved well enough to take part
  std::array<int, kMostBits> changes{};  ///< places where this bit changes at all
  /// [k][j]: where k alone changes: how often j could be read, and the share of 1 among that
  std::array<std::array<int, kMostBits>, kMostBits> seen{};
  std::array<std::array<double, kMostBits>, kMostBits> ones{};
  int neighbours = 0;   ///< neighbouring pairs looked at
  double coherent = 1;  ///< share of the entries ones[k][j < k] that are as a Gray code has them, weighted by `seen`
  double in_panel = 1;  ///< share of codes below `stripes`
  double mirrored_in_panel = 1;  ///< the same when the most significant bit is complemented
};

/// What each sample says of one bit: 0, 1 or kUndecided. `sure` keeps away from the edges of stripes; `side` only
/// leaves out noise, so that an edge lies between two neighbours even when it is blurred.
struct BitReading {
  std::vector<std::uint8_t> sure;
  std::vector<std::uint8_t> side;
};

/// Bits from 0 on, in square tiles of `side` pixels; `stripes`: codes on the panel.
BitTable count_bits(const std::vector<BitReading>& readings, int side, int stripes);

/// What is wrong with the bits, if the table shows it.
struct BitVerdict {
  std::vector<int> inverted;                     ///< bits whose pattern and inverse are exchanged
  bool all_inverted = false;                     ///< ... all that can be told
  std::optional<std::pair<int, int>> exchanged;  ///< two bits whose frames are exchanged
  bool reversed = false;                         ///< least significant first
  std::optional<int> misfit;                     ///< none of these explains it; the worst bit
  bool outside = false;                          ///< codes lie outside the panel
  bool good() const { return inverted.empty() && !exchanged && !reversed && !misfit && !outside; }
};
BitVerdict judge(const BitTable& table);

}  // namespace raysteer::calib::decode
