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

/// A whole file: its text parsed, `read(root, value, faults)` called for the keys it must have, `format` among them,
/// and every key refused that nobody asked for. The first fault is the answer: parse()'s, kUnknownKey, those of `read`.
template <class Value, class Read>
Result<Value> read_document(std::string_view text, const std::string& file, Read read) {
  const Result<toml::table> parsed = parse(text, file);
  RAYSTEER_TRY(parsed);
  Faults faults;
  TomlTable root({&*parsed}, "", faults);
  root.integer("format", {1, 1});
  Value value;
  read(root, value, faults);
  root.finish();
  RAYSTEER_TRY(faults.status());
  return value;
}

}  // namespace raysteer::proto::document
