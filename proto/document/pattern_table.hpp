// pure: [[sequence]] of sessions and plans: one block of patterns.
#pragma once

#include "hal/base/pattern.hpp"
#include "proto/document/toml_table.hpp"

namespace raysteer::proto::document {

/// Reads one [[sequence]] table. The panel's size gives `periods` its period; 0: not known, `periods` is a fault.
/// `faults` are those `table` notes into.
PatternBlock read_pattern_block(TomlTable& table, int panel_width, int panel_height, const Faults& faults);

}  // namespace raysteer::proto::document
