#include "firmware/capture/flicker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace raysteer::firmware::capture {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr std::size_t kLeastSamples = 6;
constexpr double kMattering = 0.02;  ///< of the ambient light: below the noise of a coded pixel
constexpr double kSure = 4;          ///< standard deviations

double sinc(double x) { return x == 0 ? 1 : std::sin(std::numbers::pi * x) / (std::numbers::pi * x); }

struct Fit {
  double mean = 0;
  double amplitude = 0;
  double squares = 0;  ///< left beside the fit
};

// Least squares of level = m + c cos(w t) + s sin(w t): normal equations, solved by elimination.
Fit fit_sinusoid(std::span<const AmbientSample> samples, double hz) {
  std::array<std::array<double, 4>, 3> rows{};
  for (const AmbientSample& sample : samples) {
    const double turn = 2 * std::numbers::pi * hz * Seconds(sample.middle - samples.front().middle).count();
    const std::array base{1.0, std::cos(turn), std::sin(turn)};
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        rows[i][j] += base[i] * base[j];
      }
      rows[i][3] += base[i] * sample.level;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (rows[i][i] < 1e-9) {
      return {};  // phases that tell nothing apart
    }
    for (std::size_t other = 0; other < 3; ++other) {
      const double factor = other == i ? 0 : rows[other][i] / rows[i][i];
      for (std::size_t j = i; j < 4; ++j) {
        rows[other][j] -= factor * rows[i][j];
      }
    }
  }
  const std::array solved{rows[0][3] / rows[0][0], rows[1][3] / rows[1][1], rows[2][3] / rows[2][2]};
  Fit fit{.mean = solved[0], .amplitude = std::hypot(solved[1], solved[2])};
  for (const AmbientSample& sample : samples) {
    const double turn = 2 * std::numbers::pi * hz * Seconds(sample.middle - samples.front().middle).count();
    const double left = sample.level - solved[0] - solved[1] * std::cos(turn) - solved[2] * std::sin(turn);
    fit.squares += left * left;
  }
  return fit;
}

}  // namespace

Flicker find_flicker(std::span<const AmbientSample> samples, std::chrono::nanoseconds exposure) {
  Flicker best;
  if (samples.size() < kLeastSamples) {
    return best;
  }
  double least = 0;
  for (const double hz : {100.0, 120.0}) {
    const Fit fit = fit_sinusoid(samples, hz);
    const double seen = std::abs(sinc(hz * Seconds(exposure).count()));
    if (!(fit.mean > 0) || seen < 0.1 || (best.hz != 0 && fit.squares >= least)) {
      continue;
    }
    least = fit.squares;
    const double number = static_cast<double>(samples.size());
    const double noise = std::sqrt(fit.squares / (number - 3)) * std::sqrt(2 / number);
    best = {.hz = hz, .modulation = fit.amplitude / fit.mean / seen, .sigma = noise / fit.mean / seen};
  }
  best.noticed = best.modulation > kMattering && best.modulation > kSure * best.sigma;
  return best;
}

double flicker_left(const Flicker& flicker, std::chrono::nanoseconds exposure) {
  return flicker.noticed ? flicker.modulation * std::abs(sinc(flicker.hz * Seconds(exposure).count())) : 0;
}

std::optional<std::chrono::nanoseconds> choose_exposure(const Flicker& flicker, const ExposureLimits& limits,
                                                        std::chrono::nanoseconds wanted) {
  const std::chrono::nanoseconds most = std::min(limits.most, wanted);
  if (most < limits.least || most.count() <= 0) {
    return std::nullopt;
  }
  std::chrono::nanoseconds step = most;
  if (limits.frame) {
    step = *limits.frame;
  } else if (flicker.noticed) {
    const std::chrono::nanoseconds half_period(std::llround(1e9 / flicker.hz));
    step = half_period <= most ? half_period : most;
  }
  // Longest first: a shorter one must be clearly better to be taken.
  std::optional<std::chrono::nanoseconds> best;
  double best_left = 0;
  for (auto count = most / step; count >= 1; --count) {
    const std::chrono::nanoseconds exposure = count * step;
    if (exposure < limits.least) {
      break;
    }
    const double left = flicker_left(flicker, exposure);
    if (!best || left < 0.5 * best_left - 1e-3) {
      best = exposure;
      best_left = left;
    }
  }
  return best;
}

}  // namespace raysteer::firmware::capture
