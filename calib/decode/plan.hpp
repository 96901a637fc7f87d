// value: a pattern sequence as the decoder sees it: what each frame is for, and what it waits for.
#pragma once

#include <optional>
#include <vector>

#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::decode {

/// What a Gray pattern without inverse is thresholded by.
enum class Threshold { kInverse, kWhiteAndBlack, kPhaseMean };

/// One projector axis: a Gray block, phase blocks, or both.
struct AxisPlan {
  std::optional<PatternBlock> gray;
  Threshold threshold = Threshold::kInverse;
  std::vector<int> phases;  ///< indices into Plan::phases, finest period first
  int panel = 0;            ///< pixels of the panel along this axis

  bool used() const { return gray.has_value() || !phases.empty(); }
  bool heterodyne() const { return !gray && phases.size() > 1; }
};

struct Plan {
  std::vector<Pattern> frames;
  std::vector<PatternBlock> phases;  ///< all phase blocks, in the order of the sequence
  std::vector<int> phase_of_block;   ///< block index to phase index, or -1
  AxisPlan x, y;
  bool white = false;
  bool black = false;

  AxisPlan& axis(Axis which) { return which == Axis::kX ? x : y; }
  const AxisPlan& axis(Axis which) const { return which == Axis::kX ? x : y; }
};

/// Errors: kBadSequence with what does not fit: nothing coded, two Gray blocks on one axis, nothing to threshold by,
/// stripes wider than half a period, periods that nothing orders.
Result<Plan> plan(const PatternSequence& sequence);

}  // namespace raysteer::calib::decode
