// The report's drawings, each an HTML figure with title, picture and a caption that says how to read it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/report/result.hpp"
#include "host/report/scale.hpp"

namespace raysteer::host::report {

/// Cells of a device's image (`width` x `height` px) coloured by value, the value written in each when there is room.
/// Diverging colours are symmetric about zero. Cells without a value are hatched.
std::string heat_map(const Grid& grid, int width, int height, std::string_view unit, Palette palette,
                     const Caption& caption);

/// Where the model misses each corner, drawn longer than it is by a factor that the caption states.
std::string residual_field(const std::vector<ResidualVector>& residuals, int width, int height,
                           const std::string& title);

/// RMS of kept residuals per cell, two-dimensional, about ten cells across.
Grid residual_grid(const std::vector<ResidualVector>& residuals, int width, int height);

/// One group of bars a view, one bar a device. Views that were not used are grey.
std::string view_bars(const std::vector<ViewRow>& views, const std::vector<DeviceResult>& devices);

std::string histogram(const Histogram& histogram, std::string_view unit, const Caption& caption);

}  // namespace raysteer::host::report
