// pure: a TOML text of format 1.
#pragma once

#include <string>
#include <string_view>

#include "hal/base/result.hpp"
#include "proto/document/toml_table.hpp"

namespace raysteer::proto::document {

/// Parses the text of a session, board, plan or scene and looks at its key `format`, which an included file may lack; 1
/// is the only one so far. `file` is the name in messages.
/// kTomlSyntax; kFormatVersion; kBadValue: `format` is no whole number. Each with file and line.
Result<toml::table> parse(std::string_view text, const std::string& file);

}  // namespace raysteer::proto::document
