// value: what the projector shows, as device, session, decoder and renderer all say it.
//
// Coordinates are panel pixels: (0,0) is the centre of the top-left pixel; pixel i covers [i-0.5, i+0.5].
#pragma once

#include <vector>

#include "hal/base/result.hpp"

namespace raysteer {

/// The coordinate a pattern codes. kX: the pattern changes along x (vertical stripes, "columns").
enum class Axis { kX, kY };

enum class PatternKind {
  kWhite,  ///< every pixel fully on
  kBlack,  ///< every pixel off; the camera still sees ambient light
  kGray,   ///< one bit of a Gray code
  kPhase,  ///< one step of a shifted sinusoid
};

/// A run of frames in a sequence. Fields of other kinds are ignored.
struct PatternBlock {
  PatternKind kind = PatternKind::kWhite;
  Axis axis = Axis::kX;

  // kGray: code = floor((x + 0.5 + offset_px) / stripe_px), shown as code ^ (code >> 1), most significant bit first.
  int bits = 0;
  double stripe_px = 1;  ///< width of one code value; half a period when a phase block refines it
  double offset_px = 0;
  bool inverse = false;        ///< each pattern is followed by its complement
  bool inverse_first = false;  ///< ... or preceded by it
  bool lsb_first = false;

  // kPhase: value = 1/2 + 1/2 cos(2 pi (x - origin_px) / period_px - sign * 2 pi k / steps), k = 0 .. steps-1.
  // (algorithms: N-step phase shift)
  int steps = 0;
  double period_px = 0;
  double origin_px = 0;
  int sign = 1;

  int frames() const;
  bool operator==(const PatternBlock&) const = default;
};

/// One frame of a sequence.
struct Pattern {
  PatternBlock block;  ///< the block it belongs to
  int block_index = 0;
  int bit = 0;            ///< kGray: 0 is the least significant bit of the code
  bool inverted = false;  ///< kGray: this is the complement
  int step = 0;           ///< kPhase

  /// Light at panel column x, row y (pixel centres), 0 to 1, linear.
  double value(int x, int y) const;
};

/// Everything shown for one look, in order.
struct PatternSequence {
  int panel_width = 0;
  int panel_height = 0;
  std::vector<PatternBlock> blocks;

  int frames() const;
  std::vector<Pattern> patterns() const;
  bool operator==(const PatternSequence&) const = default;
};

/// Can the sequence be projected and told apart? Errors: kBadSequence with the block and the value that does not fit.
Status check(const PatternSequence& sequence);

}  // namespace raysteer
