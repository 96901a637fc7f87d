// value: a pretend rig in front of pretend surfaces: what `raysteer session render` shows and end-to-end tests vary.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/synth/render.hpp"
#include "hal/base/pattern.hpp"
#include "hal/base/target.hpp"

namespace raysteer::calib::synth {

/// One look: what stands before the devices while the sequence is shown.
struct StagedLook {
  std::string name;
  Scene scene;
  std::vector<Sensor> sensors;  ///< as they stand during this look
};

/// A session before it is rendered.
struct Stage {
  std::string name;
  std::vector<std::string> cameras;  ///< names of the sensors
  Lamp lamp;
  double ambient = 0.02;  ///< View's
  PatternSequence sequence;
  TargetSpec target;  ///< columns = 0: none is shown
  std::vector<StagedLook> looks;
};

/// Two verging cameras 0.2 m apart and, below them, a projector that is shifted up: its principal point lies below its
/// panel. Surfaces are about 0.9 m away.
struct PretendRig {
  std::vector<Sensor> sensors;  ///< left, right; the rig's frame is left's
  Lamp lamp;

  /// left, right, projector
  model::Rig rig() const;
};

/// A rig whose lenses and places vary with the seed by some per cent. `scale` 1: cameras 640x512, panel 640x400.
PretendRig pretend_rig(std::uint64_t seed, double scale = 1);

/// The chessboard of the pretend sessions: 9 x 6 inner corners of 30 mm.
TargetSpec pretend_target();

/// Both cameras look at the target in `views` poses, lit by the white panel.
Stage cameras_stage(const PretendRig& pretend, std::uint64_t seed, int views = 18);
/// The left camera looks at the target in `views` poses under Gray code of half periods and 8 phase steps.
Stage projector_stage(const PretendRig& pretend, std::uint64_t seed, int views = 6);
/// Both cameras look at a wall, a box before it and a ball under the default code (algorithms 2.3).
Stage scan_stage(const PretendRig& pretend, std::uint64_t seed);

/// Gray code of half periods and `steps` phase steps of period 16 on both axes, then white and black.
PatternSequence half_period_sequence(int panel_width, int panel_height, bool complement, int steps = 8);

}  // namespace raysteer::calib::synth
