// pure: the point spread of a camera's lens.
#pragma once

#include <vector>

namespace raysteer::sim::world {

/// Half of a Gaussian for pictures whose pixels are means over squares, from the middle out. With s = 4 sin^2(w / 2)
/// the second difference's response, w^2 = s + s^2 / 12 + ..., so exp(-sigma^2 / 2 (s + s^2 / 12)) has a Gaussian's
/// variance and fourth moment also where it is narrower than a pixel. Its far ends may be a little below zero.
std::vector<float> lens_blur(double sigma_px);

/// One row, its ends repeated.
void blur_row(const std::vector<float>& weights, const float* row, int width, float* out);

}  // namespace raysteer::sim::world
