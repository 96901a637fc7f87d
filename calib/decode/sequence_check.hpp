// bound to one thread: do the frames of one look show the sequence they are said to show?
//
// Looks at some hundred small tiles of each frame, so that it costs a fraction of a millisecond a frame and can run
// beside the decoder: add() every frame in any order, then report().
//
// Told apart: frames all black or saturated, a frame repeated, frames in another order, pattern and inverse exchanged,
// and a scene or camera that moved between frames. Nothing is claimed of what the tiles cannot show (a bit whose edge
// lies outside the view, for example), so a good set is never refused for being seen only in part.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/region.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::decode {

/// Grey values are in levels of 255 whatever the camera's depth.
struct SequenceReport {
  double lit = 0;             ///< share of the samples that the projector reaches
  double contrast = 0;        ///< median of (brightest - darkest) over the lit samples, levels
  double brightest = 0;       ///< 99th percentile of the brightest frame, levels
  double saturated = 0;       ///< share of the lit samples that saturate in the brightest frame
  double codes_coherent = 1;  ///< Gray: share of bits that read at the edges of coarser ones as they must; worst block
  double codes_in_panel = 1;  ///< Gray: share of codes that lie on the panel, worst block
  double phase_residual = 0;  ///< phase: median departure from a sinusoid over its amplitude, worst block
  double largest_shift_px = 0;  ///< movement between groups of frames, camera px; 0 where there is no texture
  std::vector<Error> faults;    ///< worst first: kFrameCount, kFramesBlack, kFramesSaturated, kFramesDoubled,
                                ///< kFramesOutOfOrder, kInverseSwapped, kSceneMoved. Error::detail is a frame or -1.
  std::vector<Error> warnings;  ///< of the same codes, for what can be lived with
  bool good() const { return faults.empty(); }
};

class SequenceCheck {
 public:
  /// `within`: where the tiles lie, camera px; best the lit_region, since tiles that the light does not reach tell
  /// nothing. `bits`: 8 or 16, the depth of the pixels; files of 16 bits that hold 10, 12 or 14 bits are recognised by
  /// their largest value. Fewer tiles cost less and find less of what is small.
  SequenceCheck(const PatternSequence& sequence, const Region& within, int bits, int most_tiles = kMostTiles);
  /// 160,000 samples, 5 % of a frame of 3 Mpx.
  static constexpr int kMostTiles = 280;

  /// Takes what it needs of frame `index` of the sequence. The frame holds the region given to the constructor.
  void add(int index, ImageView<const std::uint8_t> frame);
  void add(int index, ImageView<const std::uint16_t> frame);

  SequenceReport report() const;
  /// The worst fault, if any.
  Status verdict() const;

 private:
  struct Corner {
    int x = 0;
    int y = 0;
  };
  template <class Pixel>
  void take(int index, ImageView<const Pixel> frame);

  PatternSequence sequence_;
  int bits_ = 8;
  int side_ = 0;                                     // of a tile, px
  std::vector<Corner> tiles_;                        // top-left
  std::vector<std::vector<std::uint16_t>> samples_;  // [frame][tile, row, column]; empty: not added
};

}  // namespace raysteer::calib::decode
