// Writes a whole file, or says why not. The one way host code writes: streams forget to report a full disk.
#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.hpp"

namespace raysteer::host::exchange {

/// Creates or replaces `path` with `bytes`, flushed to the disk. A file that could not be written whole is removed.
/// Not atomic by itself: commands write inside the folder of Context::out(), which appears at once.
/// Errors: kDiskFull, kWriteFailed.
Status write_file(const std::filesystem::path& path, std::string_view bytes);

/// The same through a hidden neighbour that is renamed: `path` holds the old bytes or all of the new ones.
Status replace_file(const std::filesystem::path& path, std::string_view bytes);

/// The whole file. Errors: kFileMissing, kFileUnreadable.
Result<std::string> read_file(const std::filesystem::path& path);

/// The error that `error_number` (errno) means when `path` was to be written.
Error write_error(const std::filesystem::path& path, int error_number);

}  // namespace raysteer::host::exchange
