// pure: from lumens to electrons, one formula a function. docs/pretend-rig.md, "Light", tells the whole chain.
#pragma once

#include <Eigen/Core>
#include <chrono>

#include "hal/base/time.hpp"
#include "sim/optics/true_rig.hpp"

namespace raysteer::sim::world {

/// Photons of white LED light: wavelength / (h c K) with 560 nm and K = 300 lm/W, the middle of what white LEDs give
/// (T. W. Murphy, "Maximum spectral luminous efficacy of white light", J. Appl. Phys. 111, 2012: 250 to 370 lm/W).
inline constexpr double kPhotonsPerLumenSecond = 560e-9 / (6.62607015e-34 * 299792458.0 * 300.0);

/// Of a camera lens's glass; four to eight coated elements.
inline constexpr double kLensTransmission = 0.9;

/// What blurs a projector's picture where it is sharpest: its lens's own point spread, standard deviation.
inline constexpr double kProjectorLensBlurPx = 0.4;

/// Solid angle that one pixel sees, steradians: |du x dv| of the unit rays half a pixel to either side. For a lens
/// without distortion this is cos^3 / (fx fy).
double pixel_solid_angle(const optics::Lens& lens, const Eigen::Vector2d& pixel);

/// Electrons per second and cd/m2 of luminance at a camera's pixel: pupil area x cos x solid angle x transmission x
/// photons x quantum efficiency; for a lens without distortion pi/4 (pitch / N)^2 cos^4, focused far away.
double electrons_per_luminance(const optics::TrueCamera& camera, const Eigen::Vector2d& q);

/// Candela that one white panel pixel's neighbourhood shines with: lumens / pixels x cos^fall_off / solid angle. Light
/// on a surface is this x cos / distance^2, lux.
double panel_intensity(const optics::TrueProjector& projector, const Eigen::Vector2d& x);

/// Standard deviation of the projector's blur at a distance along its optical axis, panel px: its lens's own, and a
/// quarter of the blur disc's diameter focal_px x pupil x |1 / z - 1 / focus|.
double projector_blur_px(const optics::TrueProjector& projector, double depth_m);

/// Lux seconds that a window gets of 1 lux that flickers as 1 + depth sin(2 pi hz t).
double flicker_integral(double depth, double hz, RigTime begin, std::chrono::nanoseconds duration);

/// Share of the incident light that leaves towards the camera, per steradian, on top of the matt part: a Blinn-Phong
/// lobe about the half vector, (n + 8) / (8 pi) (N.H)^n (T. Akenine-Moeller et al., Real-Time Rendering, 3rd ed., 7.6).
/// The half vector turns half as far as the reflected ray, so a lobe of standard deviation `gloss_rad` has
/// n = 4 / gloss_rad^2.
double gloss_lobe(double gloss, double gloss_rad, const Eigen::Vector3d& normal, const Eigen::Vector3d& to_light,
                  const Eigen::Vector3d& to_camera);

}  // namespace raysteer::sim::world
