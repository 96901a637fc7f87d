// Finds where each projector pixel is seen by one camera, and by both.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "calib/decode/code_map.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::scene {

/// Where a camera sees the centre of one projector pixel.
struct Sighting {
  Eigen::Vector2f q{0, 0};          ///< camera px
  float cxx = 0, cxy = 0, cyy = 0;  ///< covariance of q, camera px^2
  std::uint16_t pixels = 0;         ///< camera pixels whose own coordinate rounds to this projector pixel
  std::uint16_t support = 0;        ///< camera pixels used, neighbours included; 0: not seen

  bool seen() const { return support > 0; }
  /// Bracketed by its neighbours only: no camera pixel measured this projector pixel.
  bool interpolated() const { return seen() && pixels == 0; }
};

/// Sightings of all projector pixels of a panel, row by row as on the panel.
///
/// The place is the value at (i, j) of a weighted affine fit of q over the camera pixels that see the projector
/// within one pixel of (i, j), weights falling linearly to zero there: a footprint of 1.5 projector pixels
/// (noise-equivalent), no more than the stripe and its two borders. Pixels farther than 4 camera px from the pixel's
/// own centroid belong to another surface and are left out. Errors: kNothingDecoded (an axis is missing).
Result<Image<Sighting>> locate(const decode::CodeMap& map, int panel_width, int panel_height);

/// One projector pixel seen in two views.
struct Match {
  std::uint16_t i = 0, j = 0;  ///< projector column and row
  Eigen::Vector2d q_left{0, 0}, q_right{0, 0};
  Eigen::Matrix2d cov_left = Eigen::Matrix2d::Zero(), cov_right = Eigen::Matrix2d::Zero();  ///< px^2
};

struct Matches {
  std::vector<Match> measured;   ///< both cameras have measurements there; rows of the panel, then columns
  std::size_t interpolated = 0;  ///< projector pixels that only neighbours would add; not in `measured`
};

/// Projector pixels seen by both cameras.
Matches match(const Image<Sighting>& left, const Image<Sighting>& right);

/// One camera against the projector itself: q_right is the projector pixel (i, j), known exactly.
Matches match_projector(const Image<Sighting>& camera);

}  // namespace raysteer::calib::scene
