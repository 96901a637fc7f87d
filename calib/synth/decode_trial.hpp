// value: one decoder on one rendered view with known truth: how far off, how often, how honest.
#pragma once

#include <cstdint>
#include <string>

#include "calib/decode/decoder.hpp"
#include "calib/synth/separable.hpp"
#include "hal/base/pattern.hpp"

namespace raysteer::calib::synth {

/// Sequences of algorithms 2.3 along x, with white and black in front.
PatternSequence gray_sequence(int panel, bool inverse);
PatternSequence gray_phase_sequence(int panel, bool inverse, int steps, double period_px);
PatternSequence heterodyne_sequence(int panel, int steps, double first_period_px, double second_period_px);

struct DecodeTrial {
  double rms_px = 0;               ///< of pixels less than 1.5 px off
  double predicted_px = 0;         ///< root of the mean predicted variance of those
  double gross = 0;                ///< share of valid pixels further off
  double valid = 0;                ///< share of pixels on the panel
  double integer_rms_px = 0;       ///< of the code's middle, for Gray codes
  double order_residual = 0;       ///< heterodyne, periods
  double border_displacement = 0;  ///< Gray, stripes
  double scatter_px = 0;  ///< of x about the mean of its two neighbours, as of one pixel: blind to a slow shift
};

/// Errors: those of the decoder.
Result<DecodeTrial> decode_trial(const PatternSequence& sequence, const SeparableView& view,
                                 const decode::Options& options, std::uint64_t seed);

}  // namespace raysteer::calib::synth
