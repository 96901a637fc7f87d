// Phases of one projector axis to coordinates, ordered by a Gray code or by each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "calib/decode/decoder.hpp"
#include "calib/decode/noise.hpp"
#include "calib/decode/phase_rows.hpp"
#include "calib/decode/plan.hpp"

namespace raysteer::calib::decode {

/// When a phase is believed.
struct PhaseLimits {
  NoiseModel noise;
  double harmonics = 0;       ///< residual of a usual pixel by its modulation squared: gamma
  double saturation = 250;    ///< DN
  double min_modulation = 0;  ///< DN
  double min_sigma = 5;
  double max_sigma_px = 0.5;
  double max_order_residual = 0.25;
};

/// Where they go. `code` holds the half period's Gray code if the axis has one, and then the rounded coordinate.
struct PhaseOutput {
  Image<float>& value;
  Image<float>& variance;
  Image<std::uint16_t>& code;
  Image<std::uint8_t>& mask;
};

struct PhaseFindings {
  std::size_t covered = 0;   ///< pixels with enough modulation and no saturation
  float order_residual = 0;  ///< median distance of the order from an integer, periods; NaN where a Gray code orders
};

/// All pixels. `phases` are those of the plan.
PhaseFindings place_phases(const AxisPlan& axis, std::span<const PhaseSums> phases, const PhaseLimits& limits,
                           const PhaseOutput& out);

}  // namespace raysteer::calib::decode
