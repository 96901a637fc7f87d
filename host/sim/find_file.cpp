#include "host/sim/find_file.hpp"

#include <system_error>

namespace raysteer::host::sim {

Result<std::filesystem::path> find_file(const std::string& kind, const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_regular_file(name, error)) {
    return fs::path(name);
  }
  const fs::path ours = fs::path(kind) / (name + ".toml");
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (fs::path installed = here.parent_path() / "share" / "raysteer" / ours; fs::is_regular_file(installed, error)) {
    return installed;
  }
  for (fs::path folder = here; folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::path built = folder / ours; fs::is_regular_file(built, error)) {
      return built;
    }
  }
  return fail(RCode::kFileMissing, name + ": no such file, and none of " + kind + "/ has that name");
}

}  // namespace raysteer::host::sim
