#include "calib/decode/phase_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "calib/decode/median.hpp"

namespace raysteer::calib::decode {
namespace {

/// A half period from Gray and the phase may disagree by this share of a period before the pixel is ambiguous.
constexpr double kMaxDisagreement = 0.45;
/// A residual above this many times what noise and the projector's harmonics explain is no sinusoid (algorithms 2.5).
constexpr double kMaxChi2 = 9;
constexpr std::uint8_t kDark = kSaturated | kLowModulation;

/// One pixel after the other.
class PhasePixels {
 public:
  PhasePixels(const AxisPlan& axis, std::span<const PhaseSums> phases, const PhaseLimits& limits)
      : axis_(axis), limits_(limits) {
    for (const int index : axis.phases) {
      sums_.push_back(&phases[static_cast<std::size_t>(index)]);
      periods_.push_back(sums_.back()->block().period_px);
    }
    places_.resize(periods_.size());
    variances_.resize(periods_.size());
  }

  void place(int u, int v, const PhaseOutput& out, PhaseFindings& findings) {
    std::uint8_t reasons = measure(u, v);
    findings.covered += (reasons & kDark) == 0 ? 1 : 0;
    double place = 0;
    reasons |= axis_.gray ? order(out.code(u, v), place) : order_by_each_other((reasons & kDark) == 0, place);
    double variance = 0;
    reasons |= combine(place, variance);
    out.mask(u, v) |= reasons;
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    const bool valid = reasons == 0;
    out.value(u, v) = valid ? static_cast<float>(place) : kNan;
    out.variance(u, v) = valid ? static_cast<float>(variance) : kNan;
    out.code(u, v) =
        valid ? static_cast<std::uint16_t>(std::clamp(static_cast<int>(std::lround(place)), 0, axis_.panel - 1))
              : CodeMap::kNoCode;
  }

  std::vector<float>& order_residuals() { return order_residuals_; }

 private:
  /// Places modulo their periods, and their variances.
  std::uint8_t measure(int u, int v) {
    std::uint8_t reasons = 0;
    for (std::size_t i = 0; i < sums_.size(); ++i) {
      const PhaseSums::Pixel pixel = sums_[i]->pixel(u, v);
      const double noise = limits_.noise.variance(pixel.mean);
      const double power = pixel.modulation * pixel.modulation;
      places_[i] = pixel.place;
      variances_[i] = sums_[i]->variance(pixel, limits_.noise);
      if (pixel.peak >= limits_.saturation) {
        reasons |= kSaturated;
      }
      if (pixel.modulation < limits_.min_modulation || power < limits_.min_sigma * limits_.min_sigma * noise) {
        reasons |= kLowModulation;
      }
      if (pixel.residual > kMaxChi2 * (noise + limits_.harmonics * power)) {
        reasons |= kAmbiguous;
      }
    }
    return reasons;
  }

  /// Half periods order the phase (algorithms 2.4).
  std::uint8_t order(std::uint16_t stripe, double& place) const {
    const double rough = (stripe + 0.5) * axis_.gray->stripe_px - axis_.gray->offset_px - 0.5;
    place = nearest_period(places_[0], periods_[0], rough);
    const bool agree = stripe != CodeMap::kNoCode && !(std::abs(place - rough) > kMaxDisagreement * periods_[0]);
    return agree ? kValid : kAmbiguous;
  }

  std::uint8_t order_by_each_other(bool lit, double& place) {
    const Heterodyne found = heterodyne(places_, periods_, axis_.panel);
    place = found.place;
    if (places_.size() == 1) {
      return kValid;
    }
    if (lit) {
      order_residuals_.push_back(static_cast<float>(found.residual));
    }
    return found.residual > limits_.max_order_residual ? kAmbiguous : kValid;
  }

  /// Each period measures the same coordinate; they are weighted by what they know.
  std::uint8_t combine(double& place, double& variance) const {
    double weights = 0;
    double sum = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      weights += 1 / variances_[i];
      sum += nearest_period(places_[i], periods_[i], place) / variances_[i];
    }
    place = sum / weights;
    variance = 1 / weights;
    const bool vague = variance > limits_.max_sigma_px * limits_.max_sigma_px;
    const bool outside = place < -1 || place > axis_.panel;
    return static_cast<std::uint8_t>((vague ? kLowModulation : kValid) | (outside ? kOutside : kValid));
  }

  const AxisPlan& axis_;
  const PhaseLimits& limits_;
  std::vector<const PhaseSums*> sums_;
  std::vector<double> periods_, places_, variances_;
  std::vector<float> order_residuals_;
};

}  // namespace

PhaseFindings place_phases(const AxisPlan& axis, std::span<const PhaseSums> phases, const PhaseLimits& limits,
                           const PhaseOutput& out) {
  PhasePixels pixels(axis, phases, limits);
  PhaseFindings findings;
  for (int v = 0; v < out.mask.height(); ++v) {
    for (int u = 0; u < out.mask.width(); ++u) {
      pixels.place(u, v, out, findings);
    }
  }
  findings.order_residual = median(pixels.order_residuals());
  return findings;
}

}  // namespace raysteer::calib::decode
