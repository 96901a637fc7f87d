// value: how one pretend rig truly departs from its board: what a seed draws,
// and as a file for those who judge.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "hal/base/result.hpp"
#include "hal/mock/mirror_parameters.hpp"
#include "proto/board/board.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/scene/scene.hpp"

namespace raysteer::sim::rig {

struct Truth {
  std::uint64_t seed = 0;
  optics::TrueRig rig;
  std::array<hal::mock::CommandCurve, 2> curves;  ///< of the mirror's axes
};

/// Each number of the board's drawing, off by its tolerance times a normal
/// deviate (algorithms 4.8). The rig's frame is the left camera as it truly
/// stands. Errors: those of optics::rig_as_drawn().
Result<Truth> draw_truth(const proto::board::Board& board, std::uint64_t seed);

/// Where the mirror stood while a look's patterns were shown: mechanical angles,
/// radians, with repeatability, drift and bumps.
struct LookTruth {
  std::string name;
  std::array<double, 2> mirror_rad{};
};

/// truth.json (docs/truth-format.md): every parameter, the surfaces at rig time
/// 0 in the rig's frame, and looks that were taken.
std::string truth_json(const Truth& truth, const scene::Scene& scene, std::span<const LookTruth> looks = {});

}  // namespace raysteer::sim::rig
