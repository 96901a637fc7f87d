// Are the steps of each phase block those of a shifted sinusoid?
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "calib/decode/sequence_steps.hpp"
#include "calib/decode/sequence_words.hpp"

namespace raysteer::calib::decode {
namespace {

// Median departure from the sinusoid over its amplitude: 0.12 in the public set (its projector has a gamma), 0.05 when
// linear; exchanged or repeated steps give 0.4 and more.
constexpr double kMostPhaseResidual = 0.3;

// Median over the lit places of what is left beside the best sinusoid, as a part of its amplitude.
double departure(const SampledSet& set, const PhaseBlock& phase) {
  const int steps = phase.block.steps;
  std::vector<float> residuals;
  const std::size_t stride = std::max<std::size_t>(1, set.lit.size() / 20000);
  for (std::size_t n = 0; n < set.lit.size(); n += stride) {
    std::complex<double> sum;
    double mean = 0;
    double squares = 0;
    for (int k = 0; k < steps; ++k) {
      const double value = set.at(phase.first + k, set.lit[n]);
      sum += value * std::polar(1.0, 2 * std::numbers::pi * k / steps);
      mean += value / steps;
      squares += value * value / steps;
    }
    const double amplitude = 2 * std::abs(sum) / steps;
    const double left = squares - mean * mean - amplitude * amplitude / 2;
    residuals.push_back(static_cast<float>(std::sqrt(std::max(left, 0.0)) / std::max(amplitude, 1e-6)));
  }
  return percentile(std::move(residuals), 0.5);
}

}  // namespace

void judge_phase(const SampledSet& set, Findings& findings) {
  for (const PhaseBlock& phase : set.phase) {
    const int steps = phase.block.steps;
    const double residual = departure(set, phase);
    findings.report.phase_residual = std::max(findings.report.phase_residual, residual);
    const bool known = std::ranges::any_of(
        findings.disputed, [&](int frame) { return frame >= phase.first && frame < phase.first + steps; });
    if (residual > kMostPhaseResidual && !known) {
      findings.fault(RCode::kFramesOutOfOrder,
                     "frames " + std::to_string(phase.first) + " to " + std::to_string(phase.first + steps - 1) +
                         " are not the steps of a shifted sinusoid: they depart from one by " + fixed(residual) +
                         " of its amplitude",
                     phase.first);
    }
  }
}

}  // namespace raysteer::calib::decode
