// Are the steps of each phase block those of a shifted sinusoid?
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>
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

// Two steps seem exchanged when exchanging them again leaves less than this part of the departure: 0.3 for neighbours
// of 8 steps. A gamma or noise leaves all of it. Departures below the least one are noise.
constexpr double kMended = 0.7;
constexpr double kLeastMended = 0.05;

// A place's value in each step, one place after the other.
using Steps = std::vector<float>;

Steps values_of(const SampledSet& set, const PhaseBlock& phase, std::size_t most) {
  Steps values;
  const std::size_t stride = std::max<std::size_t>(1, set.lit.size() / most);
  for (std::size_t n = 0; n < set.lit.size(); n += stride) {
    for (int k = 0; k < phase.block.steps; ++k) {
      values.push_back(set.at(phase.first + k, set.lit[n]));
    }
  }
  return values;
}

// Median over the places of what is left beside the best sinusoid, as a part of its amplitude, when step k is taken
// for step order[k].
double departure(const Steps& values, const std::vector<int>& order) {
  const std::size_t steps = order.size();
  const double number = static_cast<double>(steps);
  std::vector<std::complex<double>> turns;
  for (const int k : order) {
    turns.push_back(std::polar(1.0, 2 * std::numbers::pi * k / number));
  }
  std::vector<float> residuals;
  for (std::size_t base = 0; base < values.size(); base += steps) {
    std::complex<double> sum;
    double mean = 0;
    double squares = 0;
    for (std::size_t k = 0; k < steps; ++k) {
      const double value = values[base + k];
      sum += value * turns[k];
      mean += value / number;
      squares += value * value / number;
    }
    const double amplitude = 2 * std::abs(sum) / number;
    const double left = squares - mean * mean - amplitude * amplitude / 2;
    residuals.push_back(static_cast<float>(std::sqrt(std::max(left, 0.0)) / std::max(amplitude, 1e-6)));
  }
  return percentile(std::move(residuals), 0.5);
}

std::vector<int> as_shown(const PhaseBlock& phase) {
  std::vector<int> order(static_cast<std::size_t>(phase.block.steps));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// The two frames whose exchange mends the sinusoid, if any do.
std::optional<std::pair<int, int>> find_swap(const SampledSet& set, const PhaseBlock& phase) {
  const Steps values = values_of(set, phase, 2000);
  std::vector<int> order = as_shown(phase);
  const double before = departure(values, order);
  double least = kMended * before;
  std::optional<std::pair<int, int>> best;
  for (std::size_t a = 0; a < order.size() && before > kLeastMended; ++a) {
    for (std::size_t b = a + 1; b < order.size(); ++b) {
      std::swap(order[a], order[b]);
      const double left = departure(values, order);
      std::swap(order[a], order[b]);
      if (left < least) {
        least = left;
        best = {phase.first + static_cast<int>(a), phase.first + static_cast<int>(b)};
      }
    }
  }
  return best;
}

}  // namespace

void judge_phase(const SampledSet& set, Findings& findings) {
  for (const PhaseBlock& phase : set.phase) {
    const int end = phase.first + phase.block.steps;
    const double residual = departure(values_of(set, phase, 20000), as_shown(phase));
    findings.report.phase_residual = std::max(findings.report.phase_residual, residual);
    if (std::ranges::any_of(findings.disputed, [&](int frame) { return frame >= phase.first && frame < end; })) {
      continue;
    }
    if (const auto swap = find_swap(set, phase)) {
      findings.fault(RCode::kFramesOutOfOrder,
                     "frames " + std::to_string(swap->first) + " and " + std::to_string(swap->second) +
                         " seem exchanged: only then are the steps a sinusoid",
                     swap->first);
    } else if (residual > kMostPhaseResidual) {
      findings.fault(RCode::kFramesOutOfOrder,
                     "frames " + std::to_string(phase.first) + " to " + std::to_string(end - 1) +
                         " are not the steps of a shifted sinusoid: they depart from one by " + fixed(residual) +
                         " of its amplitude",
                     phase.first);
    }
  }
}

}  // namespace raysteer::calib::decode
