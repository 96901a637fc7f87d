// pure: how much a look's pixels scatter beyond what decoding states, from what both eyes say of each other.
#pragma once

#include <span>

#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::host::rig {

/// Where eyes cannot say: one alone, too few matches, or cameras known only as drawn.
inline constexpr double kUnknownFloorPx = 0.02;

/// Standard deviation, camera px and each coordinate, that added to the matches' own explains by how much they break
/// the epipolar constraint. What is smooth over the left image (a quadratic: poses and lenses that are a little off)
/// does not count, since the solve knows of it. At least 0.002 px; kUnknownFloorPx where fewer than 50 matches say so.
double pixel_floor(const calib::scene::TwoViews& views, std::span<const calib::scene::Match> matches);

}  // namespace raysteer::host::rig
