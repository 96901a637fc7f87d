// value: light that comes by way of one other surface, for one camera and look: coarse, since it changes slowly.
//
// The panel is cut into cells; where a cell's light lands a small lamp shines on (virtual point lights: A. Keller,
// "Instant Radiosity", SIGGRAPH 1997). Each lights a coarse grid of camera pixels unless something stands between, and
// the pixels in between take the mean of their neighbours. Light therefore leaks a few pixels past depth edges, and
// nearer to a small lamp than its cell is wide the light is too even.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "hal/mock/exposure.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/seen.hpp"

namespace raysteer::sim::world {

class Bounce {
 public:
  Bounce(const Seen& seen, const Lamp& lamp, const optics::TrueProjector& projector, int threads);

  /// Adds the light that rows [first_row, end_row) of a picture send: lux at each node.
  void add(const hal::mock::PanelPicture& picture, int first_row, int end_row, float weight,
           std::vector<float>& nodes) const;
  std::size_t nodes() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  /// Lux of each pixel of a camera row.
  void row(const std::vector<float>& nodes, int y, std::vector<float>& lux) const;

 private:
  static constexpr int kCellsAcross = 24;
  static constexpr int kCellsDown = 15;

  int width_;
  int step_;
  int columns_;
  int rows_;
  std::vector<float> transfer_;  ///< nodes x cells: lux of a white cell
  std::vector<float> seen_;      ///< of each node: 1 when it sees a surface
};

}  // namespace raysteer::sim::world
