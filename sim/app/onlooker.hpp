// pure: where a person stands who looks at the pretend rig's light, and for how
// long they look.
#pragma once

#include "hal/mock/exposure.hpp"
#include "sim/rig/pretend_rig.hpp"
#include "sim/world/world.hpp"

namespace raysteer::sim::app {

/// Some steps back from where the panel's middle lands, eyes 1.7 m above the
/// floor; straight ahead where it lands nowhere.
world::RoomView beside_the_light(rig::PretendRig& rig);

/// A twentieth of a second that begins now; time passes. Everything that shines
/// is in it.
hal::mock::Exposure glance(rig::PretendRig& rig);

}  // namespace raysteer::sim::app
