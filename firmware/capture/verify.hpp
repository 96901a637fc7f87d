// pure: is this the pair that was asked for? What the devices say of it, before anyone looks at pixels.
#pragma once

#include <array>

#include "hal/base/result.hpp"
#include "hal/mirror.hpp"
#include "hal/stereo_camera.hpp"

namespace raysteer::firmware::capture {

/// kAutomaticExposure: automatic control was on, or exposure or gain are not as set; kShotDamaged; kFrameSize;
/// kFrameDepth. Names the eye, what was expected and what came.
Status verify_pair(const hal::FramePair& pair, const std::array<hal::CameraInfo, 2>& infos,
                   const hal::CameraSettings& settings);

/// kMirrorMoved: the mirror's sensor sees it further off its command than `tolerance`; says axis and by how much.
Status verify_mirror(const hal::MirrorReading& reading, const hal::MirrorAngles& command, Radians tolerance);

}  // namespace raysteer::firmware::capture
