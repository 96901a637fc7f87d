#include "calib/decode/sequence_bits.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raysteer::calib::decode {
namespace {

// A bit takes part when at least this share of the samples is decided ...
constexpr double kLeastDecided = 0.4;
// ... and when it changes at no more than one in so many neighbours: its stripes are then 4 px wide, of which at most
// half is blur.
constexpr double kMostChanges = 1.0 / 8;
// Fewer edges than this prove nothing: a scratch or a hair makes some.
constexpr int kLeastEdges = 25;
// What a bit reads at this share of another's edges is what it reads there. Sound frames reach 0.9 and more (public
// sets, 2026), an exchanged bit as much of the opposite; a few false edges in places without contrast come out in
// between.
constexpr double kClear = 0.75;
constexpr double kMostEdges = 0.8;
// All entries together, weighted: 0.96 and more in the public sets.
constexpr double kLeastCoherent = 0.85;
constexpr double kMostOutside = 0.05;

struct Labels {
  std::array<int, BitTable::kMostBits> source{};  // the bit whose data stand for this one
};

bool expected(int edge, int bit) { return bit == edge - 1; }

// What bit j mostly reads at the edges of bit k, if there were enough.
std::optional<bool> reading_at_edges(const BitTable& table, int k, int j) {
  const auto row = static_cast<std::size_t>(k);
  const auto column = static_cast<std::size_t>(j);
  if (table.seen[row][column] < kLeastEdges) {
    return std::nullopt;
  }
  const double ones = table.ones[row][column];
  return ones > kClear ? std::optional(true) : ones < 1 - kClear ? std::optional(false) : std::nullopt;
}

// Entries that contradict a Gray code, when the data of bit source[k] are taken for bit k.
int contradictions(const BitTable& table, const Labels& labels) {
  int count = 0;
  for (int k = table.finest + 1; k < table.bits; ++k) {
    for (int j = table.finest; j < k; ++j) {
      const std::optional<bool> reads_one = reading_at_edges(table, labels.source[static_cast<std::size_t>(k)],
                                                             labels.source[static_cast<std::size_t>(j)]);
      count += reads_one && *reads_one != expected(k, j) ? 1 : 0;
    }
  }
  return count;
}

Labels as_said() {
  Labels labels;
  for (int k = 0; k < BitTable::kMostBits; ++k) {
    labels.source[static_cast<std::size_t>(k)] = k;
  }
  return labels;
}

// Bits that read wrong at the edges of every coarser one; nothing when some bit reads right here and wrong there.
std::optional<std::vector<int>> find_inverted(const BitTable& table, int& told) {
  std::vector<int> inverted;
  told = 0;
  for (int j = table.finest; j + 1 < table.bits; ++j) {
    int right = 0;
    int wrong = 0;
    for (int k = j + 1; k < table.bits; ++k) {
      if (const auto reads_one = reading_at_edges(table, k, j)) {
        (*reads_one == expected(k, j) ? right : wrong) += 1;
      }
    }
    if (right > 0 && wrong > 0) {
      return std::nullopt;
    }
    told += right + wrong > 0 ? 1 : 0;
    if (wrong > 0) {
      inverted.push_back(j);
    }
  }
  return inverted;
}

// At nearly all edges of bit k, and k alone changes there, every finer bit reads what it should: k is what it says,
// however many of a finer bit's edges happen to run between the tiles (stripes as wide as tiles are apart).
bool is_vouched_for(const BitTable& table, int k) {
  const auto row = static_cast<std::size_t>(k);
  for (int j = table.finest; j < k; ++j) {
    const bool most = table.seen[row][static_cast<std::size_t>(j)] >= kMostEdges * table.changes[row];
    if (!most || reading_at_edges(table, k, j) != expected(k, j)) {
      return false;
    }
  }
  return true;
}

// A coarse bit that changes more often than a finer one does not show what it should. One edge more is fair: which
// edges are in view is chance, and one that runs along a row of tiles meets all of them or none; and the finest bits
// may be lost in blur, so that only the coarser half is judged.
std::optional<int> too_busy(const BitTable& table) {
  // Each sample has two neighbours, and a row of tiles is about as long as the root of all samples.
  const double row_of_tiles = 1.5 * std::sqrt(table.neighbours / 2.0);
  const double one_edge = std::max(0.003 * table.neighbours, row_of_tiles);
  for (int k = table.bits - 1; k > std::max(table.bits / 2, table.finest + 1); --k) {
    for (int j = table.finest + 1; j < k; ++j) {
      if (table.changes[static_cast<std::size_t>(k)] > 1.5 * table.changes[static_cast<std::size_t>(j)] + one_edge &&
          !is_vouched_for(table, k)) {
        return k;
      }
    }
  }
  return std::nullopt;
}

}  // namespace

BitTable count_bits(const std::vector<BitReading>& readings, int side, int stripes) {
  BitTable table;
  table.bits = std::min(static_cast<int>(readings.size()), BitTable::kMostBits);
  if (table.bits == 0 || readings[0].sure.empty()) {
    return table;
  }
  const std::size_t count = readings[0].sure.size();
  // Gray word and which of its bits are undecided, per sample; the sides likewise.
  std::vector<std::uint16_t> words(count);
  std::vector<std::uint16_t> unsure(count);
  std::vector<std::uint16_t> sides(count);
  std::vector<std::uint16_t> sideless(count);
  std::array<std::size_t, BitTable::kMostBits> decided{};
  std::size_t lit = 0;
  for (std::size_t i = 0; i < count; ++i) {
    unsigned word = 0;
    unsigned doubt = 0;
    unsigned side_word = 0;
    unsigned side_doubt = 0;
    for (int k = 0; k < table.bits; ++k) {
      const BitReading& reading = readings[static_cast<std::size_t>(k)];
      const std::uint8_t bit = reading.sure[i];
      side_word |= reading.side[i] == 1 ? 1U << k : 0U;
      side_doubt |= reading.side[i] == kUndecided ? 1U << k : 0U;
      word |= bit == 1 ? 1U << k : 0U;
      doubt |= bit == kUndecided ? 1U << k : 0U;
      decided[static_cast<std::size_t>(k)] += bit != kUndecided ? 1 : 0;
    }
    words[i] = static_cast<std::uint16_t>(word);
    unsure[i] = static_cast<std::uint16_t>(doubt);
    sides[i] = static_cast<std::uint16_t>(side_word);
    sideless[i] = static_cast<std::uint16_t>(side_doubt);
    lit += doubt != (1U << table.bits) - 1U ? 1 : 0;
  }

  const auto neighbours = [&](auto visit) {
    const auto area = static_cast<std::size_t>(side) * side;
    for (std::size_t base = 0; base < count; base += area) {
      for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
          const std::size_t i = base + static_cast<std::size_t>(y * side + x);
          if (x + 1 < side) {
            visit(i, i + 1);
          }
          if (y + 1 < side) {
            visit(i, i + static_cast<std::size_t>(side));
          }
        }
      }
    }
  };
  std::array<int, BitTable::kMostBits> decided_pairs{};
  neighbours([&](std::size_t a, std::size_t b) {
    const unsigned doubt = sideless[a] | sideless[b];
    const unsigned change = (sides[a] ^ sides[b]) & ~doubt;
    for (int k = 0; k < table.bits; ++k) {
      const unsigned bit = 1U << k;
      decided_pairs[static_cast<std::size_t>(k)] += (doubt & bit) == 0 ? 1 : 0;
      table.changes[static_cast<std::size_t>(k)] += (change & bit) != 0 ? 1 : 0;
    }
    table.neighbours += doubt != (1U << table.bits) - 1U ? 1 : 0;
  });

  // Only a fine end is cut off: a coarse bit that is not resolved is a fault to be found.
  table.finest = 0;
  for (int k = 0; k < (table.bits + 1) / 2; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const bool resolved = static_cast<double>(decided[at]) >= kLeastDecided * static_cast<double>(lit) &&
                          table.changes[at] <= kMostChanges * std::max(decided_pairs[at], 1);
    table.finest = resolved ? table.finest : k + 1;
  }

  const unsigned used = ((1U << table.bits) - 1U) & ~((1U << table.finest) - 1U);
  neighbours([&](std::size_t a, std::size_t b) {
    const unsigned doubt = unsure[a] | unsure[b];
    const unsigned change = (sides[a] ^ sides[b]) & used & ~(sideless[a] | sideless[b]);
    if (change == 0 || (change & (change - 1)) != 0) {
      return;
    }
    const int k = __builtin_ctz(change);
    for (int j = 0; j < table.bits; ++j) {
      if (j != k && ((doubt >> j) & 1U) == 0) {
        ++table.seen[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)];
        table.ones[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)] += (words[a] >> j) & 1U;
      }
    }
  });
  double right = 0;
  double all = 0;
  for (int k = 0; k < table.bits; ++k) {
    for (int j = 0; j < table.bits; ++j) {
      double& ones = table.ones[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)];
      const int seen = table.seen[static_cast<std::size_t>(k)][static_cast<std::size_t>(j)];
      if (j >= table.finest && j < k) {
        right += expected(k, j) ? ones : seen - ones;
        all += seen;
      }
      ones /= std::max(seen, 1);
    }
  }
  table.coherent = all > 0 ? right / all : 1;

  std::size_t codes = 0;
  std::size_t inside = 0;
  std::size_t mirrored_inside = 0;
  const int largest = (1 << table.bits) - 1;
  for (std::size_t i = 0; i < count; ++i) {
    if ((unsure[i] & used) != 0) {
      continue;
    }
    unsigned code = words[i] & used;
    code ^= code >> 1U;
    code ^= code >> 2U;
    code ^= code >> 4U;
    code ^= code >> 8U;
    const int least = static_cast<int>(code & used);
    const int least_mirrored = static_cast<int>(static_cast<unsigned>(largest - least) & used);
    ++codes;
    inside += least < stripes ? 1 : 0;
    mirrored_inside += least_mirrored < stripes ? 1 : 0;
  }
  if (codes > 0) {
    table.in_panel = static_cast<double>(inside) / static_cast<double>(codes);
    table.mirrored_in_panel = static_cast<double>(mirrored_inside) / static_cast<double>(codes);
  }
  return table;
}

BitVerdict judge(const BitTable& table) {
  BitVerdict verdict;
  const Labels said = as_said();
  if (contradictions(table, said) > 0) {
    int told = 0;
    if (const auto inverted = find_inverted(table, told)) {
      verdict.inverted = *inverted;
      verdict.all_inverted = static_cast<int>(inverted->size()) == told && told > 1;
      return verdict;
    }
    Labels reversed = said;
    std::reverse(reversed.source.begin(), reversed.source.begin() + table.bits);
    if (table.finest == 0 && contradictions(table, reversed) == 0) {
      verdict.reversed = true;
      return verdict;
    }
    for (int a = table.finest; a < table.bits; ++a) {
      for (int b = a + 1; b < table.bits; ++b) {
        Labels labels = said;
        std::swap(labels.source[static_cast<std::size_t>(a)], labels.source[static_cast<std::size_t>(b)]);
        if (contradictions(table, labels) == 0) {
          verdict.exchanged = {a, b};
          return verdict;
        }
      }
    }
    int most = 0;
    for (int k = table.finest + 1; k < table.bits; ++k) {
      int wrong = 0;
      for (int j = table.finest; j < k; ++j) {
        const std::optional<bool> reads_one = reading_at_edges(table, k, j);
        wrong += reads_one && *reads_one != expected(k, j) ? 1 : 0;
      }
      if (wrong > most) {
        most = wrong;
        verdict.misfit = k;
      }
    }
    return verdict;
  }
  if (1 - table.in_panel > kMostOutside) {
    if (1 - table.mirrored_in_panel <= kMostOutside) {
      verdict.inverted = {table.bits - 1};
    } else {
      verdict.outside = true;
    }
    return verdict;
  }
  verdict.misfit = table.coherent < kLeastCoherent ? std::optional(table.bits - 1) : too_busy(table);
  return verdict;
}

}  // namespace raysteer::calib::decode
