#include "proto/document/paths.hpp"

#include <algorithm>
#include <cstddef>

namespace raysteer::proto::document {

bool is_file_name(std::string_view name) {
  constexpr std::size_t kLongest = 64;
  return !name.empty() && name.size() <= kLongest && name != "." && name != ".." &&
         std::ranges::all_of(name, [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
                  c == '-';
         });
}

std::optional<std::string> leaves_folder(std::string_view path) {
  if (path.starts_with('/')) {
    return "is absolute";
  }
  if (path.find('\0') != std::string_view::npos) {
    return "holds a zero byte";
  }
  if (path.find('\\') != std::string_view::npos) {
    return "holds a backslash; write '/' between folders";
  }
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (path.substr(begin, end - begin) == "..") {
      return "goes up with '..'";
    }
    begin = end + 1;
  }
  return std::nullopt;
}

}  // namespace raysteer::proto::document
