// pure: a steered projector as a list of numbers that may vary freely, in one order everywhere (docs/mirror-model.md).
//
// Order: lens fx fy cx cy k1 k2 p1 p2; pose rx ry rz tx ty tz (left increment); galvo pair: for each mirror axis (2),
// point (2), normal (2), offset; head: outer axis (2), outer point (2), inner axis (2), inner point (2), normal (2),
// offset; then gain, quadratic, cubic, cross-talk of both axes. Directions move along two tangents, points of a line
// across it: what is left out changes nothing (algorithms 4.4).
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calib/model/steered_projector.hpp"

namespace raysteer::calib::model {

inline constexpr int kLensParameters = 8;
inline constexpr int kPoseParameters = 6;
inline constexpr int kCurveParameters = 8;
inline constexpr int kMostSteeredParameters = 36;

/// Of the mirror: 14 for a galvo pair, 11 for a head.
int mirror_parameters(MirrorKind kind);
/// All: 36 or 33.
int steered_parameters(MirrorKind kind);
/// "fx", ..., "mirror1.axis_a", ..., "axis2.gain"
std::vector<std::string> steered_parameter_names(MirrorKind kind);

/// Two unit vectors across a unit vector; the same ones for the same vector.
Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& unit);

/// The projector moved by `delta` in the order above. The lens is BC4.
SteeredProjector perturbed(const SteeredProjector& projector, const Eigen::VectorXd& delta);
/// The delta that takes `from` to `to`; what changes nothing (points along their lines) is dropped.
Eigen::VectorXd departure(const SteeredProjector& from, const SteeredProjector& to);

}  // namespace raysteer::calib::model
