#include "sim/app/find_file.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "hal/base/nearest.hpp"

namespace raysteer::sim::app {
namespace {

namespace fs = std::filesystem;

// The folder that holds boards/, scenes/ and plans/.
std::optional<fs::path> share() {
  std::error_code error;
  const fs::path here = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (const fs::path installed = here.parent_path() / "share" / "raysteer"; fs::exists(installed / "boards", error)) {
    return installed;
  }
  for (fs::path folder = here; folder.has_relative_path(); folder = folder.parent_path()) {
    if (fs::exists(folder / "boards" / "mock-galvo.toml", error)) {
      return folder;
    }
  }
  return std::nullopt;
}

}  // namespace

Result<fs::path> find_file(const std::string& kind, const std::string& name) {
  std::error_code error;
  if (fs::is_regular_file(name, error)) {
    return fs::path(name);
  }
  const std::optional<fs::path> folder = share();
  if (name.find('/') == std::string::npos && folder) {
    if (fs::path file = *folder / kind / (name + ".toml"); fs::is_regular_file(file, error)) {
      return file;
    }
  }
  std::vector<std::string> names;
  if (folder) {
    for (const auto& entry : fs::directory_iterator(*folder / kind, error)) {
      if (entry.path().extension() == ".toml") {
        names.push_back(entry.path().stem().string());
      }
    }
  }
  std::ranges::sort(names);
  const std::vector<std::string_view> known(names.begin(), names.end());
  std::string note = name + ": no such file, and none of " + kind + "/ has that name" + did_you_mean(name, known);
  for (std::size_t i = 0; i < names.size(); ++i) {
    note += (i == 0 ? " There are: " : ", ") + names[i];
  }
  return fail(RCode::kFileMissing, note);
}

Result<std::string> read_text(const fs::path& file) {
  std::error_code error;
  if (!fs::exists(file, error)) {
    return fail(RCode::kFileMissing, file.string());
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream || fs::is_directory(file, error)) {
    return fail(RCode::kFileUnreadable, file.string());
  }
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

}  // namespace raysteer::sim::app
