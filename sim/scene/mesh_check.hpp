// pure: what every mesh from a file must be.
#pragma once

#include <string>

#include "hal/base/result.hpp"
#include "sim/scene/mesh.hpp"

namespace raysteer::sim::scene {

/// kMeshEmpty: no faces; kMeshNotFinite: a vertex with NaN or infinity; kMeshIndex: a face names a vertex that is not
/// there.
Status check_mesh(const Mesh& mesh, const std::string& file);

}  // namespace raysteer::sim::scene
