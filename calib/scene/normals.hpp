// Which way the surface faces at each point of a cloud.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "calib/scene/match.hpp"
#include "calib/scene/triangulate.hpp"

namespace raysteer::calib::scene {

/// Unit normals towards the left view, from the points within two projector pixels and 2 % of the depth; zero where
/// fewer than 5 of them are there. They are for drawing: the points themselves are not smoothed.
std::vector<Eigen::Vector3f> normals(std::span<const CloudPoint> points, std::span<const Match> matches);

}  // namespace raysteer::calib::scene
