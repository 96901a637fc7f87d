// pure: a frame looked at through a sparse grid: some thousand pixels stand for all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "hal/base/frame.hpp"
#include "hal/base/region.hpp"

namespace raysteer::firmware::capture {

/// Levels at the grid's places, row by row; 1 is full scale.
using Samples = std::vector<float>;

/// Saturated from here on: 250 of 255.
inline constexpr float kSaturated = 0.98F;

class Grid {
 public:
  Grid() = default;
  /// Sizes in px; `bits` of a pixel. About 4000 places, rows shifted against each other so that no stripe hides.
  Grid(int width, int height, int bits);

  /// The frame has the grid's size (RAYSTEER_CHECK).
  Samples sample(const Frame& frame) const;
  std::size_t size() const { return places_.size(); }
  /// What `places` of the grid cover, but for a few stray ones; everything where there are none. Camera px.
  Region around(std::span<const std::uint32_t> places) const;

 private:
  int width_ = 0;
  int height_ = 0;
  float level_ = 1;
  std::vector<std::size_t> places_;  ///< in a frame's pixels
};

/// The value that `share` of the values lie below; 0 of none.
float quantile(std::vector<float> values, double share);
double mean(std::span<const float> values);

}  // namespace raysteer::firmware::capture
