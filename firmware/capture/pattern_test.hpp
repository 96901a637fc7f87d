// pure: does each frame show the pattern it should? Looked at on the grid, against white, black and its partners.
//
// With n = (frame - black) / (white - black): pattern and complement add up to 1 at every place, whatever the scene,
// blur and interreflection, since light adds; the steps of a sinusoid form one, but for
// the projector's gamma, which is the same everywhere. A picture that is wrong, late, torn or
// stale does not. Gray patterns without complement have no partner here; calib/decode's sequence check sees to them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "firmware/capture/references.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::firmware::capture {

struct WrongFrame {
  int index = 0;            ///< of the sequence
  double share = 0;         ///< of the places that contradict
  std::string contradicts;  ///< "its complement, frame 7"
};

/// `frames`: each frame's samples in order of the sequence; nothing where a frame is not there (yet).
std::vector<WrongFrame> find_wrong_frames(const PatternSequence& sequence, const References& references,
                                          const std::vector<std::optional<EyeSamples>>& frames);

/// Contrast of the finest pattern that can be judged, 0 to 1, the worse eye: near 1 when in focus. Nothing without
/// complements or sinusoids.
std::optional<double> finest_contrast(const PatternSequence& sequence, const References& references,
                                      const std::vector<std::optional<EyeSamples>>& frames);

}  // namespace raysteer::firmware::capture
