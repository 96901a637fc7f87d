// Does a pixel agree with those around it?
#pragma once

#include "calib/decode/code_map.hpp"

namespace raysteer::calib::decode {

/// A valid pixel whose code (per axis) fewer than `fewest` of its 8 neighbours share within `reach_x`, `reach_y`: it
/// mixes two surfaces, or a bit flipped. Sets kEdge. Codes of unused axes are empty.
void mark_edges(CodeMap& map, int reach_x, int reach_y, int fewest);

}  // namespace raysteer::calib::decode
