// value: the steps of the sequence check, in the order they are taken. Private to the sequence check.
//
// Each looks only at what the steps before left undisputed, so that one bad frame is complained of once.
#pragma once

#include <string>
#include <vector>

#include "calib/decode/sequence_check.hpp"
#include "calib/decode/sequence_set.hpp"

namespace raysteer::calib::decode {

/// What was found so far.
struct Findings {
  SequenceReport report;
  std::vector<int> disputed;     ///< frames that have a fault already
  int broken_pairs = 0;          ///< patterns and inverses that do not complement each other
  bool black_frame_lit = false;  ///< a black frame shows light

  void fault(RCode rcode, std::string note, int frame = -1);
  void warn(RCode rcode, std::string note, int frame = -1);
  void dispute(const std::vector<int>& frames);
  bool is_disputed(int frame) const;
};

/// All black, all saturated, or a projector that shows nothing. False: nothing more can be said.
bool judge_light(const SampledSet& set, Findings& findings);
/// Frames that lost their light, or have too much, while the others are sound.
void judge_single_frames(const SampledSet& set, Findings& findings);
/// Frames that are alike though they show different stripes.
void judge_doubled(const SampledSet& set, Findings& findings);
/// White that is dark, black that is bright, patterns and inverses that do not complement each other.
void judge_complements(const SampledSet& set, Findings& findings);
/// Bits of a Gray code that do not fit each other.
void judge_codes(const SampledSet& set, Findings& findings);
/// Steps that form no sinusoid.
void judge_phase(const SampledSet& set, Findings& findings);
/// A scene or camera that moved between frames.
void judge_movement(const SampledSet& set, Findings& findings);

}  // namespace raysteer::calib::decode
