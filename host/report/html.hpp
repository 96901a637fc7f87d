// pure: text made safe for HTML and SVG.
#pragma once

#include <string>
#include <string_view>

namespace raysteer::host::report {

/// & < > " replaced, so that names from a session cannot become markup.
std::string escape(std::string_view text);

/// Base64 (RFC 4648), for data URIs.
std::string base64(std::string_view bytes);

}  // namespace raysteer::host::report
