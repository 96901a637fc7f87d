// Where tests find the tree they were built from, the programs beside them, and the real captures.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace raysteer::support {

inline std::filesystem::path program_folder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

/// The source tree: the nearest folder above the test program that has the presets.
inline std::filesystem::path source_root() {
  std::filesystem::path folder = program_folder();
  while (!std::filesystem::exists(folder / "CMakePresets.json") && folder.has_relative_path()) {
    folder = folder.parent_path();
  }
  return folder;
}

/// The real captures, or nothing where there are none (tests then print why they skip).
inline std::optional<std::filesystem::path> captures() {
  const char* named = std::getenv("RAYSTEER_DATA_DIR");
  const std::filesystem::path folder = named != nullptr ? named : source_root().parent_path() / "shared" / "data";
  if (std::filesystem::exists(folder / "stereo-graycode-bag")) {
    return folder;
  }
  return std::nullopt;
}

}  // namespace raysteer::support
