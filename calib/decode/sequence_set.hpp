// value: the samples of one set of frames, sorted by what each frame should show. Private to the sequence check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hal/base/pattern.hpp"

namespace raysteer::calib::decode {

/// 24 px hold three stripes of 8 px or a shift of 6 px.
inline constexpr int kTileSide = 24;
/// Below this many levels between brightest and darkest the projector does not reach a place.
inline constexpr float kLitLevels = 10;
inline constexpr float kSaturatedLevel = 250;
/// A place is bright or dark when it lies this far from the middle of its own range, of which 1 is the whole.
inline constexpr float kDecided = 0.15F;
/// A frame shows next to nothing but bright, or nothing but dark, beyond this share: its stripe edges are out of view.
inline constexpr double kNearlyAll = 0.9;

/// [frame][tile, row, column], as the files have them
using Samples = std::vector<std::vector<std::uint16_t>>;

/// Frames of one bit: pattern, and its inverse if there is one.
struct BitFrames {
  int pattern = -1;
  int inverse = -1;
};

struct GrayBlock {
  PatternBlock block;
  std::vector<BitFrames> bits;  ///< 0 is the least significant
};

struct PhaseBlock {
  PatternBlock block;
  int first = 0;  ///< frame
};

/// Every frame at every sample; levels of 255. Looks at the sequence and samples it was made of.
class SampledSet {
 public:
  /// `bits`: 8 or 16, the depth of the pixels. `side`: of a tile, px. No frame may be empty.
  SampledSet(const PatternSequence& sequence, const Samples& samples, int bits, int side);

  std::size_t count() const { return samples_.front().size(); }
  int frames() const { return static_cast<int>(samples_.size()); }
  float at(int frame, std::size_t i) const { return level_ * samples_[static_cast<std::size_t>(frame)][i]; }
  PatternKind kind(int frame) const { return patterns_[static_cast<std::size_t>(frame)].block.kind; }
  float range(std::size_t i) const { return high[i] - low[i]; }
  /// Share of the lit samples of a frame that lie above `part` of their own range.
  double bright_share(int frame, float part = 0.5F) const;

  const PatternSequence& sequence;
  const int side;
  std::vector<int> white;
  std::vector<int> black;
  std::vector<GrayBlock> gray;
  std::vector<PhaseBlock> phase;
  std::vector<float> low;        ///< the darkest each sample gets ...
  std::vector<float> high;       ///< ... and the brightest
  std::vector<std::size_t> lit;  ///< samples that the projector reaches

 private:
  void sort_frames();
  void find_range();

  std::vector<Pattern> patterns_;
  const Samples& samples_;
  float level_;
};

/// The value that `share` of the values lie below. At least one value.
float percentile(std::vector<float> values, double share);

}  // namespace raysteer::calib::decode
