// value: what one camera saw of the projector, per camera pixel.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "hal/base/image.hpp"

namespace raysteer::calib::decode {

/// Why a pixel has no projector coordinate: bits of CodeMap::mask. 0 is valid. kInterpolated alone keeps a coordinate.
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

/// How the frames fared as a whole.
struct Diagnostics {
  std::size_t pixels = 0;  ///< of the camera
  std::size_t valid = 0;   ///< mask == kValid
  /// Noise of one frame as it was used: variance = read_sigma_dn^2 + signal / electrons_per_dn, DN^2.
  double read_sigma_dn = 0;
  double electrons_per_dn = std::numeric_limits<double>::infinity();
  /// Heterodyne axes: median distance of the period's order from an integer, in periods; NaN without.
  double order_residual_x = std::numeric_limits<double>::quiet_NaN();
  double order_residual_y = std::numeric_limits<double>::quiet_NaN();
  /// Gray axes: RMS displacement of stripe borders from where the sequence puts them, in stripes; 0 unless the picture
  /// was scaled on its way to the panel. Coordinates are then measured with the borders' true places.
  double border_displacement_x = 0;
  double border_displacement_y = 0;
  /// Share of pixels with enough modulation and no saturation, before order and neighbours are asked.
  double coverage = 0;
};

/// Sizes are the camera's. Axes that the sequence does not code are empty; codes only: coordinates are empty too.
struct CodeMap {
  Image<float> x, y;                    ///< projector px, sub-pixel; NaN where `mask` says so
  Image<float> variance_x, variance_y;  ///< px^2, predicted from noise and contrast
  /// Integer Gray value as coded (stripes of the block's stripe_px), or the order of the finest period where there is
  /// no Gray block; kNoCode where undecided.
  Image<std::uint16_t> code_x, code_y;
  Image<std::uint8_t> mask;  ///< bits of Reason
  Diagnostics diagnostics;
  static constexpr std::uint16_t kNoCode = 0xffff;
};

}  // namespace raysteer::calib::decode
