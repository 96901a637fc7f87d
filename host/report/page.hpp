// Draws a result as one self-contained HTML page: no network, no scripts, readable on paper.
#pragma once

#include <filesystem>
#include <string>

#include "host/report/result.hpp"

namespace raysteer::host::report {

/// `folder` holds the picture the result names; a missing one is left out.
std::string page(const AnyResult& result, const std::filesystem::path& folder);

}  // namespace raysteer::host::report
