// What the bits of a Gray code are good for, by how wide their stripes are.
#pragma once

#include <vector>

#include "calib/decode/gray_sums.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::decode {

/// By bit. The two finest bits with resolved stripes show direct light; those above them are coarse.
std::vector<BitRole> roles_of(const PatternBlock& block);

/// How many stripes of the finest bit `panel` pixels have.
int codes_of(const PatternBlock& block, int panel);

}  // namespace raysteer::calib::decode
