// pure: how far a steered projector is from its drawing, in standard deviations of what a workshop delivers.
#pragma once

#include <Eigen/Dense>

#include "calib/steer/drawing.hpp"

namespace raysteer::calib::steer {

/// One standard deviation of each parameter (order of calib/model/steered_parameters.hpp), to scale by.
Eigen::VectorXd prior_sigma(const Drawing& drawing);

/// Residuals of the prior, one a parameter; the first two are focal length and aspect instead of fx and fy.
Eigen::VectorXd prior_residuals(const Drawing& drawing, const Eigen::VectorXd& sigma,
                                const model::SteeredProjector& projector);

/// The same, and their derivatives by a move of `projector` in units of `sigma`.
Eigen::VectorXd prior_residuals(const Drawing& drawing, const Eigen::VectorXd& sigma,
                                const model::SteeredProjector& projector, Eigen::MatrixXd& by_move);

}  // namespace raysteer::calib::steer
