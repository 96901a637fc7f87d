// Draws a scanned cloud as a small shaded picture, as the projector sees it.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace raysteer::host::report {

/// A point and the projector pixel that lit it.
struct PanelPoint {
  int i = 0, j = 0;           ///< projector column and row
  float x = 0, y = 0, z = 0;  ///< metres
};

/// PNG bytes, at most 900 px wide: hue is depth (z), brightness the slope against the light beside the viewer.
/// An empty string when there are no points.
std::string cloud_picture(std::span<const PanelPoint> points, int panel_width, int panel_height);

}  // namespace raysteer::host::report
