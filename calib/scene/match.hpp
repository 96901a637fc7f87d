// Finds where the nodes of a lattice on the projector's panel are seen by one camera, and by both.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

/// Where a camera sees one node of the panel: the centre of a projector pixel.
struct Sighting {
  Eigen::Vector2f q{0, 0};          ///< camera px
  float cxx = 0, cxy = 0, cyy = 0;  ///< covariance of q, camera px^2
  std::uint16_t pixels = 0;         ///< camera pixels whose own coordinate rounds to this node
  std::uint16_t support = 0;        ///< camera pixels used, neighbours included; 0: not seen

  bool seen() const { return support > 0; }
  /// Bracketed by its neighbours only: no camera pixel measured this node.
  bool interpolated() const { return seen() && pixels == 0; }
};

/// Spacing of nodes that suits both views, projector px: 1 (every projector pixel) where a camera pixel sees about one
/// or less, otherwise one and a half camera pixels, since what lies between camera pixels is not measured. The coarser
/// view counts. Maps that lack an axis are left to locate().
int node_spacing(const decode::CodeMap& left, const decode::CodeMap& right);

/// Sightings of the nodes (0, 0), (spacing, 0), ... of a panel, row by row as on the panel.
///
/// The place is the value at the node of a weighted affine fit of q over the camera pixels that see the projector
/// within one spacing of the node, weights falling linearly to zero there: a footprint of 1.5 spacings
/// (noise-equivalent); with one pixel, no more than the stripe and its two borders. Pixels farther than 4 camera px
/// from the node's own centroid belong to another surface and are left out. Errors: kNothingDecoded (an axis is
/// missing).
Result<Image<Sighting>> locate(const decode::CodeMap& map, int panel_width, int panel_height, int spacing = 1);

/// One node seen in two views.
struct Match {
  std::uint16_t i = 0, j = 0;  ///< column and row of the node; times the spacing: of the projector's pixel
  Eigen::Vector2d q_left{0, 0}, q_right{0, 0};
  Eigen::Matrix2d cov_left = Eigen::Matrix2d::Zero(), cov_right = Eigen::Matrix2d::Zero();  ///< px^2
};

struct Matches {
  std::vector<Match> measured;   ///< both cameras have measurements there; rows of the panel, then columns
  std::size_t interpolated = 0;  ///< nodes that only neighbours would add; not in `measured`
};

/// Nodes seen by both cameras.
Matches match(const Image<Sighting>& left, const Image<Sighting>& right);

/// One camera against the projector itself: q_right is the node's projector pixel, known exactly.
Matches match_projector(const Image<Sighting>& camera, int spacing = 1);

}  // namespace raysteer::calib::scene
