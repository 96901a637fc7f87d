// Projected discs: the pictures that show them, and their places in a camera's frames.
//
// Each disc is known by a number that it blinks: picture 0 shows all discs, picture 1 + b those whose number has bit b.
// No order of a grid has to be guessed then, whatever mirrors turned or flipped, and hidden discs do no harm.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "hal/base/frame.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::target {

/// Discs on the panel; centres at whole pixels, so that a disc's grey edges are alike on all sides.
struct DiscGrid {
  int columns = 0;
  int rows = 0;
  int left_px = 0;  ///< centre of disc 0
  int top_px = 0;
  int pitch_px = 0;
  double radius_px = 0;

  int discs() const { return columns * rows; }
  Eigen::Vector2d centre(int id) const {
    return {left_px + pitch_px * (id % columns), top_px + pitch_px * (id / columns)};
  }
  /// All discs; the bits of id + 1; the parity of those bits.
  int pictures() const;
};

/// A grid that fills the panel, about `across` discs wide, with gaps as wide as the discs.
DiscGrid fill_panel(int width, int height, int across);

/// Panel picture `index` of the grid; 255 on the discs, on black.
Image<std::uint8_t> disc_picture(const DiscGrid& grid, int panel_width, int panel_height, int index);

/// A disc as one camera saw it.
struct Disc {
  int id = 0;
  Eigen::Vector2d q;     ///< middle of its light (not the image of its middle), camera px
  double sigma_px = 0;   ///< per coordinate, from the grey around it
  double radius_px = 0;  ///< of a circle of its area
};

/// Frames of one camera, all of one depth and size: the black panel, the white panel, and grid.pictures() pictures.
/// What the white panel does not light much is not looked at; discs that are cut, touch others or blink no possible
/// number are left out. Errors: kFrameCount, kFrameSize, kFrameDepth, kFramesBlack (the white panel lights nothing),
/// kDiscsNotFound (fewer than 6).
Result<std::vector<Disc>> detect_discs(const DiscGrid& grid, const Frame& black, const Frame& white,
                                       std::span<const Frame> pictures);

}  // namespace raysteer::calib::target
