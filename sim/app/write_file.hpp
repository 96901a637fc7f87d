// pure but for the disk: whole files or none.
#pragma once

#include <filesystem>
#include <string_view>

#include "hal/base/result.hpp"

namespace raysteer::sim::app {

/// Through a hidden neighbour that is renamed: `file` holds the old bytes or
/// all of the new ones. kDiskFull, kWriteFailed.
Status write_whole(const std::filesystem::path& file, std::string_view bytes);

}  // namespace raysteer::sim::app
