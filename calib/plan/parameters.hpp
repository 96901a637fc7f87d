// pure: what a workshop may get wrong, as one vector in units of its tolerance: the prior is the unit covariance.
#pragma once

#include <Eigen/Dense>

#include "calib/steer/drawing.hpp"

namespace raysteer::calib::plan {

/// Parameters of a steered projector: lens 8, pose 6, mirrors 14 (galvo pair) or 11 (head), command curves 8.
int parameter_count(model::MirrorKind kind);

/// The drawing's projector with each parameter off by `sigmas` of its tolerance. Directions move by their two tangent
/// coordinates, points across their axis, since along it nothing changes (docs/mirror-model.md).
model::SteeredProjector moved(const steer::Drawing& drawing, const Eigen::VectorXd& sigmas);

}  // namespace raysteer::calib::plan
