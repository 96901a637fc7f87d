// value: what one camera saw of the projector, per camera pixel.
#pragma once

#include <cstdint>

#include "hal/base/image.hpp"

namespace raysteer::calib::decode {

/// Why a pixel has no projector coordinate (or a doubtful one): bits of CodeMap::mask. 0 is valid.
enum Reason : std::uint8_t {
  kValid = 0,
  kShadow = 1 << 0,         ///< white is not brighter than black: the projector does not reach it
  kLowModulation = 1 << 1,  ///< pattern and inverse, or the sinusoid, differ too little for the noise
  kSaturated = 1 << 2,
  kAmbiguous = 1 << 3,     ///< a bit could not be decided, or period and code disagree
  kOutside = 1 << 4,       ///< the code lies outside the panel
  kEdge = 1 << 5,          ///< mixes two surfaces (depth edge) or has no neighbour to agree with
  kInterpolated = 1 << 6,  ///< has a coordinate, but from neighbours only: not a measurement
};

/// Sizes are the camera's. Axes that the sequence does not code are empty.
struct CodeMap {
  Image<float> x, y;                    ///< projector px, sub-pixel; NaN where `mask` says so
  Image<float> variance_x, variance_y;  ///< px^2, predicted from noise and contrast
  Image<std::uint16_t> code_x, code_y;  ///< integer code (Gray value), kNoCode where undecided
  Image<std::uint8_t> mask;             ///< bits of Reason
  static constexpr std::uint16_t kNoCode = 0xffff;
};

}  // namespace raysteer::calib::decode
