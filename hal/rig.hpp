// value: the devices of one rig, whatever they are made of. Owned by whoever built them.
#pragma once

#include "hal/blob_store.hpp"
#include "hal/clock.hpp"
#include "hal/interlock.hpp"
#include "hal/mirror.hpp"
#include "hal/pattern_player.hpp"
#include "hal/projector.hpp"
#include "hal/stereo_camera.hpp"
#include "hal/trigger.hpp"

namespace raysteer::hal {

struct Rig {
  const Clock& clock;
  Interlock& interlock;
  Mirror& mirror;
  Projector& projector;
  PatternPlayer* player;  ///< nullptr: a display projector, which cannot play by itself
  Trigger& trigger;
  StereoCamera& cameras;
  BlobStore& store;
};

}  // namespace raysteer::hal
