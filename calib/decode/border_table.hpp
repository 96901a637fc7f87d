// value: where the borders between stripes really lie on the panel.
//
// A projector that is fed more pixels than it has drops or blends columns: of three borders two may coincide (1920
// columns shown on 1280 mirrors). Border n of a Gray code is then not at n stripes. All rows of a frame see the same
// borders, so their places are learnt from the capture: each is moved until, over many lines, it lies where the borders
// around it say. What moves slowly over the panel cannot be told from the surface's shape and is left alone.
#pragma once

#include <vector>

#include "calib/decode/classify.hpp"
#include "calib/decode/gray_sums.hpp"

namespace raysteer::calib::decode {

struct BorderTable {
  /// Place of border n, in stripes; empty: borders are where they should be.
  std::vector<float> place;
  /// How far a single crossing scatters about its border beyond the frames' noise, stripes^2: texture of the surface,
  /// interpolation between pixels.
  float excess_variance = 0;
  /// RMS of place[n] - n over the borders seen, stripes; 0 where borders are where they should be.
  float displacement = 0;
};

/// From `lines` of Gray sums, each `limits.width` pixels long and running across the stripes.
template <class T>
BorderTable learn_borders(const GrayStore<T>& lines, int count, const GrayLimits& limits);

}  // namespace raysteer::calib::decode
