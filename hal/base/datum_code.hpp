// value: the codes of coded ring datums: what is printed, surveyed and seen in the room.
//
// A datum is a white disc of radius r on black; from 2 r to 3 r a ring of 12 sectors is white where the bit of its code
// is one, lowest bit first from +x towards +y. How it is turned does not matter: a code is the smallest number among
// its rotations.
#pragma once

#include <span>

#include "hal/base/result.hpp"

namespace raysteer {

inline constexpr int kDatumBits = 12;

/// The codes that are offered, rising: every two differ in at least three sectors however they are turned, and none
/// looks like itself turned, so that one sector misread is noticed and two never make another code.
std::span<const unsigned> datum_codes();
/// The smallest number among the rotations of a code's twelve bits.
unsigned smallest_rotation(unsigned code);
/// Is `code` (turned as it may be) one that is offered? kBadValue lists those that are.
Status check_datum_code(unsigned code);

}  // namespace raysteer
