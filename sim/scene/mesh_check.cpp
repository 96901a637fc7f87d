#include "sim/scene/mesh_check.hpp"

#include <algorithm>

namespace raysteer::sim::scene {

Status check_mesh(const Mesh& mesh, const std::string& file) {
  if (mesh.triangles.empty()) {
    return fail(RCode::kMeshEmpty, file + " has no faces");
  }
  const auto bad = std::ranges::find_if(mesh.vertices, [](const Eigen::Vector3d& p) { return !p.allFinite(); });
  if (bad != mesh.vertices.end()) {
    return fail(RCode::kMeshNotFinite,
                file + ": vertex " + std::to_string(bad - mesh.vertices.begin() + 1) + " is not finite");
  }
  for (const Triangle& triangle : mesh.triangles) {
    if (std::ranges::max(triangle) >= mesh.vertices.size()) {
      return fail(RCode::kMeshIndex, file + ": a face names vertex " + std::to_string(std::ranges::max(triangle) + 1) +
                                         " of " + std::to_string(mesh.vertices.size()));
    }
  }
  return ok();
}

}  // namespace raysteer::sim::scene
