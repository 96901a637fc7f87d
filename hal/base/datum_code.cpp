#include "hal/base/datum_code.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace raysteer {
namespace {

// Among the 335 numbers of twelve bits that differ from all their rotations: at least four changes round the ring,
// three to nine sectors white, three sectors' difference from each other and from themselves turned. Found by 1500
// random greedy selections; the longest had 16.
constexpr std::array<unsigned, 16> kCodes{0x017, 0x04f, 0x065, 0x073, 0x089, 0x0b5, 0x0d1, 0x13b,
                                          0x159, 0x1e9, 0x2cd, 0x2fb, 0x37f, 0x39f, 0x3ad, 0x56f};

}  // namespace

std::span<const unsigned> datum_codes() { return kCodes; }

unsigned smallest_rotation(unsigned code) {
  constexpr unsigned kMask = (1U << kDatumBits) - 1;
  unsigned smallest = code & kMask;
  for (unsigned turn = 1; turn < kDatumBits; ++turn) {
    smallest = std::min(smallest, ((code >> turn) | (code << (kDatumBits - turn))) & kMask);
  }
  return smallest;
}

Status check_datum_code(unsigned code) {
  if (code < (1U << kDatumBits) && std::ranges::binary_search(kCodes, smallest_rotation(code))) {
    return ok();
  }
  std::string known;
  for (const unsigned each : kCodes) {
    known += ' ' + std::to_string(each);
  }
  return fail(RCode::kBadValue, "datum code " + std::to_string(code) + " is too like another one; take one of" + known);
}

}  // namespace raysteer
