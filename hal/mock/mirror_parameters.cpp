#include "hal/mock/mirror_parameters.hpp"

#include <numbers>
#include <string>

#include "hal/base/nearest.hpp"

namespace raysteer::hal::mock {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHz = 2 * std::numbers::pi;

MirrorLimits symmetric(double axis1, double axis2) {
  return {.least = {Radians(-axis1), Radians(-axis2)}, .most = {Radians(axis1), Radians(axis2)}};
}

/// A 10-mm-beam galvo pair: 8,000 deg/s and 7e6 deg/s^2 fit the published half-travel and small-angle figures of such
/// pairs (+-10 deg at 130 Hz, +-0.2 deg at 1 kHz, 0.4 ms for a 0.2 deg step); 16-bit command over +-20 deg.
MirrorParameters galvo() {
  MirrorParameters mirror;
  mirror.limits = symmetric(12 * kDegree, 12 * kDegree);
  mirror.settle = {.tolerance = Radians(100e-6), .window = std::chrono::microseconds(1'000)};
  for (AxisParameters& axis : mirror.axes) {
    axis.curve.half_range = 12 * kDegree;
    axis.dynamics = {.delay_s = 20e-6,
                     .rate = 8'000 * kDegree,
                     .acceleration = 7e6 * kDegree,
                     .natural = 2'500 * kHz,
                     .damping = 0.7};
    axis.sensor = {.offset = 10e-6, .gain = 50e-6, .noise = 5e-6, .rail = 21 * kDegree};
    axis.errors = {.repeatability = 20e-6,
                   .hysteresis = 0,
                   .warm_offset = 100e-6,
                   .warm_gain = 0,
                   .room_offset = 15e-6,
                   .room_gain = 50e-6};
    axis.command_step = 40 * kDegree / 65'536;
    axis.travel = 20.5 * kDegree;
  }
  return mirror;
}

/// A mirror head before a projector: two geared axes with 16-bit commands over a control link that takes 25 ms,
/// trapezoidal motion. Its maker's figures are not public; these are assumptions.
MirrorParameters head(double repeatability, double hysteresis) {
  MirrorParameters mirror;
  mirror.limits = symmetric(40 * kDegree, 14 * kDegree);
  mirror.settle = {.tolerance = Radians(250e-6), .window = std::chrono::microseconds(40'000)};
  const std::array half_range{40 * kDegree, 14 * kDegree};
  for (std::size_t i = 0; i < 2; ++i) {
    AxisParameters& axis = mirror.axes[i];
    axis.curve.half_range = half_range[i];
    axis.dynamics = {
        .delay_s = 25e-3, .rate = 120 * kDegree, .acceleration = 600 * kDegree, .natural = 12 * kHz, .damping = 0.8};
    axis.sensor = {.offset = 15e-6, .gain = 50e-6, .noise = 10e-6, .rail = 60 * kDegree};
    axis.errors = {.repeatability = repeatability,
                   .hysteresis = hysteresis,
                   .warm_offset = 60e-6,
                   .warm_gain = 0,
                   .room_offset = 10e-6,
                   .room_gain = 20e-6};
    axis.command_step = 2 * half_range[i] / 65'536;
    axis.travel = half_range[i] + 2 * kDegree;
  }
  return mirror;
}

}  // namespace

Result<MirrorParameters> mirror_preset(std::string_view name) {
  if (name == "galvo") {
    return galvo();
  }
  if (name == "head") {
    return head(20e-6, 0);
  }
  if (name == "cheap-head") {
    return head(200e-6, 100e-6);
  }
  constexpr std::array<std::string_view, 3> kNames{"galvo", "head", "cheap-head"};
  return fail(RCode::kBadValue, "a mirror moves as 'galvo', 'head' or 'cheap-head', got '" + std::string(name) + "'" +
                                    did_you_mean(name, kNames));
}

}  // namespace raysteer::hal::mock
