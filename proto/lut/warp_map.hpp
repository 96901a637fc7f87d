// value: for one station, what content each panel pixel shows, and how bright. Bytes: docs/lut-format.md.
//
// The panel is cut into square cells. The corners of a cell carry content coordinates in homogeneous form (u w, v w, w)
// with w the inverse depth, which a pinhole sees as straight lines on every plane: between the corners only the lens's
// bend is interpolated. Cells that a depth edge crosses hold every pixel.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::proto::lut {

inline constexpr int kLargestSide = 16384;  ///< of panel and content, pixels
inline constexpr int kLargestCell = 64;     ///< panel pixels
/// Steps of one content pixel in fixed point.
inline constexpr int kSubPixel = 256;
/// A gain of 1: all of the content's linear light.
inline constexpr int kFullGain = 32768;
inline constexpr std::size_t kLongestName = 64;

/// How the pixels of a cell get their values.
enum class CellKind : std::uint8_t {
  kEmpty = 0,   ///< no pixel shows anything
  kGrid = 1,    ///< all pixels, interpolated from the cell's corners
  kMasked = 2,  ///< interpolated; a bit for each pixel says whether it shows anything
  kDense = 3    ///< every pixel is stored
};

/// A corner of cells. Content coordinate in pixels: (u / w, v / w) * 2^exponent.
struct WarpNode {
  std::int32_t u = 0;
  std::int32_t v = 0;
  std::int32_t w = 0;
  std::uint16_t gain = 0;  ///< times kFullGain; what comes out above 1 counts as 1

  bool operator==(const WarpNode&) const = default;
};

/// A pixel of a dense cell. A pixel that shows nothing is all zeros.
struct WarpSample {
  std::int32_t u = 0;  ///< content pixels times kSubPixel
  std::int32_t v = 0;
  std::uint16_t gain = 0;  ///< at most kFullGain

  bool operator==(const WarpSample&) const = default;
};

struct WarpMapParts {
  std::string name;     ///< of the station, 1 to 64 bytes
  int panel_width = 0;  ///< pixels
  int panel_height = 0;
  int content_width = 0;  ///< pixels; (0,0) is the middle of the top left one
  int content_height = 0;
  std::array<std::int32_t, 2> command_nrad{};  ///< of the mirror, for which alone the map holds
  int cell_px = kLargestCell;                  ///< 8, 16, 32 or 64
  int exponent = 0;                            ///< -62 to 62
  double bound_px = 0;                         ///< no content coordinate is further from exact geometry, content pixels
  double worst_px = 0;                         ///< the worst of all pixels when baked; at most bound_px
  double gain_bound = 0;                       ///< no gain is further from exact, as a part of 1
  double boost = 1;             ///< the darkest place gets at most so many times the share of the brightest; at least 1
  double metres_per_px = 0;     ///< of content, in the middle of a rectangle to scale; 0: not to scale
  double tolerance_m = 0;       ///< that the station asks for; 0: none
  std::vector<CellKind> cells;  ///< row by row
  std::vector<WarpNode> nodes;  ///< row by row, one column and one row more than cells
  std::vector<std::uint8_t> masks;  ///< of the masked cells in turn: cell_px^2 / 8 bytes, row by row, lowest bit first
  std::vector<WarpSample> dense;    ///< of the dense cells in turn: cell_px^2 pixels, row by row

  int columns() const { return (panel_width + cell_px - 1) / cell_px; }
  int rows() const { return (panel_height + cell_px - 1) / cell_px; }
  bool operator==(const WarpMapParts&) const = default;
};

class WarpMap {
 public:
  /// Errors: kTableDamaged (sizes that do not fit each other or the limits, numbers out of range, a corner at or behind
  /// the lens).
  static Result<WarpMap> make(WarpMapParts parts);

  const WarpMapParts& parts() const { return parts_; }
  int columns() const { return parts_.columns(); }
  int rows() const { return parts_.rows(); }
  CellKind kind(int column, int row) const { return parts_.cells[cell(column, row)]; }
  const WarpNode& node(int column, int row) const {
    return parts_.nodes[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns() + 1) +
                        static_cast<std::size_t>(column)];
  }
  /// First byte of a masked cell's bits.
  const std::uint8_t* mask(int column, int row) const { return parts_.masks.data() + starts_[cell(column, row)]; }
  /// First pixel of a dense cell.
  const WarpSample* dense(int column, int row) const { return parts_.dense.data() + starts_[cell(column, row)]; }
  bool operator==(const WarpMap& other) const { return parts_ == other.parts_; }

 private:
  explicit WarpMap(WarpMapParts parts) : parts_(std::move(parts)) {}
  std::size_t cell(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns()) + static_cast<std::size_t>(column);
  }

  WarpMapParts parts_;
  std::vector<std::size_t> starts_;  ///< of each cell in masks or dense
};

}  // namespace raysteer::proto::lut
