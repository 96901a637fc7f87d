// pure: white and black, seen through the grid: what is lit, how brightly, and does it stay so?
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "firmware/capture/grid.hpp"
#include "hal/base/result.hpp"

namespace raysteer::firmware::capture {

using EyeSamples = std::array<Samples, 2>;  ///< left, right

/// One eye's view of the lit scene.
struct EyeReference {
  Samples white;
  Samples black;
  std::vector<std::uint32_t> lit;  ///< places of the grid that white changes
  double lit_share = 0;
  double saturated_share = 0;  ///< of the lit places
  double bright = 0;           ///< level that 0.5 % of the lit places exceed in white
  double contrast = 0;         ///< median of white - black over the lit places
  double ambient = 0;          ///< median of black over the lit places
};

struct References {
  std::array<EyeReference, 2> eyes;
};

References make_references(EyeSamples white, EyeSamples black);

/// What the references say of the exposure.
enum class ExposureVerdict { kGood, kTooLong, kTooShort };
ExposureVerdict judge_exposure(const References& references);
/// The exposure by which the present one should be multiplied.
double exposure_factor(const References& references);

/// Fit to code with, whatever the exposure can still do? kNothingLit, kTooBright, kTooDark, each naming the eye.
Status judge_light(const References& references);

/// Brightness of a picture that is the same all over: 0 as black, 1 as white; over both eyes' lit places.
double uniform_level(const References& references, const EyeSamples& seen);

/// White again, after the patterns: has anything moved? A lamp that got brighter as a whole has not. kSceneMoved names
/// the eye and the share that changed.
Status judge_stillness(const References& references, const EyeSamples& white);

}  // namespace raysteer::firmware::capture
