#include "host/sim/board_file.hpp"

#include <system_error>

namespace raysteer::host::sim {

Result<std::filesystem::path> board_file(const std::string& board) {
  namespace fs = std::filesystem;
  std::error_code error;
  if (fs::is_regular_file(board, error)) {
    return fs::path(board);
  }
  const fs::path name = fs::path("boards") / (board + ".toml");
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (fs::path installed = here.parent_path() / "share" / "raysteer" / name; fs::is_regular_file(installed, error)) {
    return installed;
  }
  for (fs::path folder = here; folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::path built = folder / name; fs::is_regular_file(built, error)) {
      return built;
    }
  }
  return fail(RCode::kFileMissing, board + ": no such file, and none of boards/ has that name");
}

}  // namespace raysteer::host::sim
