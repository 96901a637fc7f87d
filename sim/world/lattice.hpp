// pure: where a pixel that an edge crosses is sampled.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

namespace raysteer::sim::world {

/// Fibonacci lattice in the unit square about 0: 34 samples whose shadows on both axes are 34 equal steps, so that even
/// an edge along a pixel's side is hit to 1/68 of the pixel (I. H. Sloan, S. Joe, Lattice Methods, 1994).
inline constexpr int kSamples = 34;

inline const std::array<Eigen::Vector2d, kSamples>& samples() {
  static const auto points = [] {
    std::array<Eigen::Vector2d, kSamples> all;
    for (int i = 0; i < kSamples; ++i) {
      all[static_cast<std::size_t>(i)] = {(i + 0.5) / kSamples - 0.5, (21 * i % kSamples + 0.5) / kSamples - 0.5};
    }
    return all;
  }();
  return points;
}

}  // namespace raysteer::sim::world
