// Clouds of several looks become one surface: a map of depths over the left eye's directions, and its mesh.
//
// The left eye stands still while the mirror turns, so whatever look lit a place, that eye saw it in one direction and
// at one depth: a surface larger than one look needs no registration, and where looks overlap they can be compared
// direction by direction. What that eye does not see is not in the map. docs/scan.md says how the numbers come about.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "calib/scene/match.hpp"
#include "calib/scene/triangulate.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

struct FuseOptions {
  double apart_m = 0.003;      ///< looks disagree at a place beyond this and 5 sigma
  double most_apart = 0.1;     ///< share of a pair's common places that may disagree
  double flattest_rad = 1.43;  ///< a triangle seen flatter than this (82 degrees off its normal) spans a depth edge
};

/// How two looks agree where both saw the surface: distances along the left eye's ray.
struct Overlap {
  std::size_t first = 0, second = 0;  ///< looks
  std::size_t shared = 0;             ///< places
  double median_mm = 0, p95_mm = 0;   ///< of absolute distances, nothing left out
  double bias_mm = 0;                 ///< median of second minus first
  double whitened = 0;                ///< 1.4826 MAD over the stated sigma: about 1 where that is true
  double apart = 0;                   ///< share of places that disagree
};

struct FusedLook {
  std::string name;
  std::size_t points = 0;   ///< of its cloud
  std::size_t places = 0;   ///< nodes of the map it measures
  std::size_t dropped = 0;  ///< of these, against what most others say
};

struct FusedSurface {
  std::vector<Eigen::Vector3d> points;  ///< metres, left view's frame
  std::vector<float> sigma_m;  ///< of each along the left eye's ray, as the overlaps say it is; calibration exact
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< facing the left eye against the clock
  double cell = 0;                                      ///< of the map, in X/Z
  std::vector<FusedLook> looks;
  std::vector<Overlap> overlaps;  ///< pairs with 50 common places and more
  std::size_t shared = 0;         ///< over all pairs
  double median_mm = std::numeric_limits<double>::quiet_NaN();
  double p95_mm = std::numeric_limits<double>::quiet_NaN();  ///< both NaN where no looks overlap
  std::size_t contested = 0;  ///< places left out: looks disagree and none is in the majority
};

/// Side of the map's cells that suits a look's points, in X/Z: twice the median distance of neighbours on the panel.
/// Errors: kTooFewMatches (no neighbours).
Result<double> cell_for(std::span<const CloudPoint> points, std::span<const Match> matches);

class Fusion {
 public:
  /// `cell` > 0: in X/Z of the left view.
  explicit Fusion(double cell, const FuseOptions& options = {}) : cell_(cell), options_(options) {}

  /// One look's cloud becomes its own map: at each node an affine fit of 1/z, which is exact on planes, over the points
  /// within a cell, weighted by their covariance and a tent; of two surfaces at a depth edge the one with more weight.
  void add(std::string name, std::span<const CloudPoint> points);

  /// All looks' maps become one. Errors: kTooFewMatches (fewer than 100 places), kSurfacesApart (names the look that
  /// disagrees with most others, and by how much).
  Result<FusedSurface> fuse() const;

 private:
  struct Node {
    float w = 0;      ///< 1/z; 0: not measured
    float sigma = 0;  ///< of w
  };
  /// Nodes of one look over its own part of the grid.
  struct Map {
    FusedLook look;
    int left = 0, top = 0;
    Image<Node> nodes;

    const Node* at(int x, int y) const {
      const Node* node = x >= left && y >= top && x < left + nodes.width() && y < top + nodes.height()
                             ? &nodes(x - left, y - top)
                             : nullptr;
      return node != nullptr && node->w > 0 ? node : nullptr;
    }
  };
  Eigen::Vector2d direction(int x, int y) const { return cell_ * Eigen::Vector2d(x, y); }
  Overlap compare(std::size_t first, std::size_t second, std::vector<double>& all_m) const;
  Node joined(int x, int y, std::vector<const Node*>& at, FusedSurface& surface) const;
  void mesh(const Image<std::uint32_t>& index, FusedSurface& surface) const;
  bool agree(const Node& a, const Node& b) const;

  double cell_;
  FuseOptions options_;
  std::vector<Map> maps_;
};

}  // namespace raysteer::calib::scene
