// pure: what may name a file, and what may lead out of a folder.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace raysteer::proto::document {

/// Letters, digits, '.', '_' and '-', 1 to 64 of them, neither "." nor "..": what stands for itself in a file's name on
/// every system.
bool is_file_name(std::string_view name);

/// Why `path` may leave the folder it starts in ("is absolute", "goes up with '..'"), if it may. Symbolic links are
/// the reader's care.
std::optional<std::string> leaves_folder(std::string_view path);

}  // namespace raysteer::proto::document
