// Maps over a device's image: how unsure its projection is, and how two calibrations of it differ.
#pragma once

#include <Eigen/Dense>
#include <optional>

#include "calib/assess/assessment.hpp"
#include "calib/model/camera.hpp"

namespace raysteer::calib::assess {

constexpr int kMapColumns = 10;  // algorithms 1.4
constexpr int kMapRows = 8;

/// Sigma of the projection of points at one range (m; infinity: directions), px, larger axis. `covariance` is that of
/// fx fy cx cy and the lens's coefficients. An error of these would have moved the calibration's poses with it: the
/// rigid motion that best explains it at `fitted_range_m`, where the target was, is taken out (mrcal's projection
/// uncertainty). So the map is best at that range.
GridMap uncertainty_map(const model::Camera& camera, const Eigen::MatrixXd& covariance, double range_m,
                        double fitted_range_m);

/// Length of the difference of two calibrations of one device, px of the first, after the rotation between them that
/// makes it smallest is taken out. Cells that one of them cannot see are NaN.
GridMap difference_map(const model::Camera& first, const model::Camera& second);

/// Value below which the part `share` of the finite cells lies; NaN when there is none.
double quantile(const GridMap& map, double share);

}  // namespace raysteer::calib::assess
