// A stage becomes a session on disk: session.toml, PNG frames, and truth.json with what is true of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "calib/model/rig.hpp"
#include "calib/synth/stage.hpp"
#include "hal/base/result.hpp"

namespace raysteer::host::pretend {

/// Called now and then with the part done (0 to 1). False: stop; the work then returns kCancelled.
using Tick = std::function<bool(double done)>;

/// Renders every frame of `stage` into `folder` (which is created): CAMERA/LOOK_INDEX.png. `rig` is the truth written
/// beside it. The same stage and seed give the same bytes. Errors: kDiskFull, kWriteFailed, kCancelled.
Status write_session(const calib::synth::Stage& stage, const calib::model::Rig& rig, std::uint64_t seed,
                     const std::filesystem::path& folder, const Tick& tick = {});

}  // namespace raysteer::host::pretend
