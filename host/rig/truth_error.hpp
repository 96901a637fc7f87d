// pure: how far a solved rig is from the truth at looks it never saw. For pretend rigs only.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calib/steer/solve.hpp"
#include "hal/base/result.hpp"
#include "host/pretend/truth_file.hpp"
#include "host/rig/stations.hpp"

namespace raysteer::host::rig {

/// Over the points of the looks: the panel pixel that truly lights a place, without the mirror's repeatability, against
/// the pixel that the solution says, given the place as its own cameras see it.
struct TruthError {
  double median_px = 0, p95_px = 0;
  double median_mm = 0, p95_mm = 0;  ///< across the light
  std::size_t points = 0;
};

/// Errors: kCalibrationMismatch (the truth has other cameras), kTooFewCorrespondences (no point left).
Result<TruthError> truth_error(const calib::steer::Solution& solution, const pretend::TruthFile& truth,
                               std::span<const calib::steer::Look> looks);

/// Where the true projector lights what should be a station's corners, room frame, with the mirror as its truth says it
/// stands at `angles_rad`, or without it where its command truly leads: no repeatability, no drift. Of the truth both
/// `projector` and `T_room_rig` are there.
std::array<Eigen::Vector3d, 4> lit_corners(const AimedStation& station, const pretend::TruthFile& truth,
                                           const std::optional<Eigen::Vector2d>& angles_rad = {});

}  // namespace raysteer::host::rig
