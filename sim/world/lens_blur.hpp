// pure: the point spread of a camera's lens.
#pragma once

#include <vector>

namespace raysteer::sim::world {

/// Half of a Gaussian for sampled pictures, from the middle out: exp(-t) I_n(t) with t = sigma^2. Its variance is
/// sigma^2 also where the samples are coarser than the Gaussian (T. Lindeberg, Scale-Space for Discrete Signals, 1990).
std::vector<float> lens_blur(double sigma_px);

/// One row, its ends repeated.
void blur_row(const std::vector<float>& weights, const float* row, int width, float* out);

}  // namespace raysteer::sim::world
