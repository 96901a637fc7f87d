// value: which part of the panel lights what each camera pixel sees, at one mirror position: traced once per look,
// after which a picture costs a resampling.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/world/lamp.hpp"
#include "sim/world/seen.hpp"

namespace raysteer::sim::world {

/// Where a camera pixel's piece of surface lies on the panel.
///
/// Its parallelogram is taken as a box per axis, as wide as the longer of its two sides there, the shorter side's
/// variance added to the blur: that keeps the mean and the variance, and nine tenths of the shape, of each axis.
struct Footprint {
  float x = 0, y = 0;                   ///< panel px, centre
  float wide = 1, high = 1;             ///< of the box
  std::uint8_t blur_x = 0, blur_y = 0;  ///< blur_level()
  float gain = 0;                       ///< electrons per second when the panel is white and the lamp's power 1
};
struct PartFootprint {
  Footprint at;
  int column = 0;
};

class Lit {
 public:
  Lit(const Seen& seen, const Lamp& lamp, int threads);

  int width() const { return width_; }
  std::span<const Footprint> row(int y) const {
    return {prints_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width_),
            static_cast<std::size_t>(width_)};
  }
  std::span<const PartFootprint> parts(int y) const {
    const auto at = static_cast<std::size_t>(y);
    return {parts_.data() + first_part_[at], first_part_[at + 1] - first_part_[at]};
  }
  /// Which blur levels occur.
  const std::vector<bool>& levels() const { return levels_; }
  std::size_t bytes() const {
    return prints_.capacity() * sizeof(Footprint) + parts_.capacity() * sizeof(PartFootprint);
  }

 private:
  int width_;
  std::vector<Footprint> prints_;
  std::vector<PartFootprint> parts_;
  std::vector<std::size_t> first_part_;
  std::vector<bool> levels_;
};

}  // namespace raysteer::sim::world
