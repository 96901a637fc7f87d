#include "calib/decode/bit_roles.hpp"

#include <cmath>
#include <cstddef>

namespace raysteer::calib::decode {
namespace {

/// Stripes at least this wide show direct light even where the projector is blurred by 2 px.
constexpr double kDirectStripe = 8;

/// Stripes of bit b are 2^(b+1) codes wide, but for the most significant.
double stripe_of(const PatternBlock& block, int bit) { return std::ldexp(block.stripe_px, bit + 1); }

}  // namespace

std::vector<BitRole> roles_of(const PatternBlock& block) {
  std::vector<BitRole> roles(static_cast<std::size_t>(block.bits));
  int first = 0;
  while (first + 2 < block.bits && stripe_of(block, first) < kDirectStripe) {
    ++first;
  }
  for (int bit = 0; bit < block.bits; ++bit) {
    roles[bit] = {.bit = bit, .direct = bit == first || bit == first + 1, .coarse = bit > first + 1};
  }
  return roles;
}

int codes_of(const PatternBlock& block, int panel) {
  return static_cast<int>(std::ceil((panel + block.offset_px) / block.stripe_px));
}

}  // namespace raysteer::calib::decode
