// pure: the scene file (docs/scene-format.md) and the meshes and pictures it names.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"
#include "sim/scene/scene.hpp"

namespace raysteer::sim::scene {

/// Reads `text`; the scene it includes, meshes and pictures are looked for beside `file`. Errors name file, line and
/// what was expected: kTomlSyntax, kFormatVersion, kUnknownKey, kMissingKey, kBadValue, kPathOutside, and for a mesh or
/// picture kMeshMissing, kMeshSyntax, kMeshEmpty, kMeshNotFinite, kMeshIndex, kTextureMissing, kTextureFormat.
Result<Scene> read_scene(std::string_view text, const std::filesystem::path& file);

/// The same from a file. Also kFileMissing, kFileUnreadable.
Result<Scene> load_scene(const std::filesystem::path& file);

/// A triangle mesh from a file's bytes; faces with more corners are fans. OBJ: v, f, vt are read, other lines are left
/// alone. PLY: ascii or binary_little_endian. kMeshSyntax, kMeshEmpty, kMeshNotFinite, kMeshIndex.
Result<Mesh> read_obj(std::string_view bytes, const std::string& file);
Result<Mesh> read_ply(std::string_view bytes, const std::string& file);

}  // namespace raysteer::sim::scene
