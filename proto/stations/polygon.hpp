// pure: is an outline of corners one that encloses something? Inside proto/stations only.
#pragma once

#include <array>
#include <string>
#include <vector>

namespace raysteer::proto::stations {

/// Empty, or what is wrong with the corners: no area, an outline that crosses itself, corners that are not in one plane
/// (by more than 1 % of the outline's extent).
std::string polygon_fault(const std::vector<std::array<double, 3>>& corners);

}  // namespace raysteer::proto::stations
