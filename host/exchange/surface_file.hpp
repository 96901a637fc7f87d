// The scanned surface as a file, surface.ply: a mesh that other programs open too, and that 'raysteer bake' takes back.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::host::exchange {

struct SurfaceFile {
  std::string rig_id;                                   ///< of the calibration it was measured with
  std::vector<Eigen::Vector3d> points;                  ///< metres, rig frame
  std::vector<float> sigma_m;                           ///< of each along the left eye's ray
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< against the clock as the left eye sees them
};

inline constexpr const char* kSurfaceFile = "surface.ply";

/// The file's bytes, with normals; `grey` of each point, or empty.
std::string to_ply(const SurfaceFile& surface, const std::vector<std::uint8_t>& grey = {});
/// What to_ply() wrote; `name` for errors: kMeshSyntax (not such a file, or cut short), kMeshIndex,
/// kMeshNotFinite, kMeshEmpty (no triangle).
Result<SurfaceFile> surface_from_ply(std::string_view bytes, std::string_view name);
/// Reads a file, or surface.ply in a folder. Also errors kFileMissing, kFileUnreadable.
Result<SurfaceFile> read_surface(const std::filesystem::path& path);

}  // namespace raysteer::host::exchange
