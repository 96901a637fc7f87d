// value: what one axis' Gray patterns tell about noise, from a grid of pixels.
//
// Pattern plus inverse is white plus black, whatever the bit: from one coarse bit to the next only noise changes, and
// some global light, which a neighbouring pixel shares. A pattern without inverse is compared with the last coarse one
// that was as bright.
#pragma once

#include <vector>

#include "calib/decode/noise.hpp"
#include "hal/base/image.hpp"

namespace raysteer::calib::decode {

/// A grid of at most this many pixels is enough for 1 % at each of 16 signal levels.
inline constexpr int kNoiseColumns = 256;
inline constexpr int kNoiseRows = 64;

class NoiseSamples {
 public:
  /// The next coarse bit: pattern `p` and inverse `q`, which was taken (`pairs`) or made from a threshold. Pixels of
  /// `saturated` DN and more tell nothing. `estimate` gets the differences from the bit before.
  template <class T>
  void add(ImageView<const T> p, ImageView<const T> q, bool pairs, int saturated, NoiseEstimate& estimate);
  void clear() { before_.clear(); }

 private:
  std::vector<int> before_;  ///< what the coarse bit before showed at the sampled pixels
};

}  // namespace raysteer::calib::decode
