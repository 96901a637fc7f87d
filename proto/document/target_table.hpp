// pure: [[target]] of sessions, plans and scenes: a printed calibration target.
#pragma once

#include "hal/base/target.hpp"
#include "proto/document/toml_table.hpp"

namespace raysteer::proto::document {

/// Reads what is printed: kind, columns, rows, square_m, marker_m, dictionary, layout. Other keys, and finish(), are
/// the caller's.
TargetSpec read_target_spec(TomlTable& table);

}  // namespace raysteer::proto::document
