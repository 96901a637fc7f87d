// pure: does the ambient light flicker with the mains, and which exposure does not see it?
#pragma once

#include <chrono>
#include <optional>
#include <span>

namespace raysteer::firmware::capture {

/// Mean brightness of one short exposure of the unlit scene.
struct AmbientSample {
  std::chrono::nanoseconds middle{};  ///< of the exposure, on any one clock
  double level = 0;
};

struct Flicker {
  double hz = 0;          ///< 100 or 120: twice the mains
  double modulation = 0;  ///< amplitude over mean of the unlit scene's level, the sensor's own black level included
  double sigma = 0;       ///< of `modulation`
  bool noticed = false;   ///< beyond doubt, and enough to matter
};

/// Least-squares fit of a constant and a sinusoid at 100 and at 120 Hz; the better one is given. At least 6 samples at
/// staggered phases, else nothing is noticed. `exposure`: of each sample; what it averages away is put back.
Flicker find_flicker(std::span<const AmbientSample> samples, std::chrono::nanoseconds exposure);

/// What is left of a flicker in an exposure: |sinc(hz * exposure)| of its modulation.
double flicker_left(const Flicker& flicker, std::chrono::nanoseconds exposure);

struct ExposureLimits {
  std::chrono::nanoseconds least{};  ///< of the camera
  std::chrono::nanoseconds most{};   ///< of the camera, or where the lit scene would saturate
  /// A display projector dithers over its frames: only whole ones are shown alike. Nothing: any exposure will do.
  std::optional<std::chrono::nanoseconds> frame;
};

/// The longest exposure within the limits that sees least of the flicker; without flicker, simply the longest, but no
/// longer than `wanted`. Nothing when not even one frame fits.
std::optional<std::chrono::nanoseconds> choose_exposure(const Flicker& flicker, const ExposureLimits& limits,
                                                        std::chrono::nanoseconds wanted);

}  // namespace raysteer::firmware::capture
