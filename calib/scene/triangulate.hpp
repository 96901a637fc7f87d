// Matches become points with covariance; those whose rays do not meet are left out.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "calib/scene/match.hpp"
#include "calib/scene/two_views.hpp"

namespace raysteer::calib::scene {

struct CloudPoint {
  Eigen::Vector3d p;           ///< metres, left view's frame
  Eigen::Matrix3d covariance;  ///< m^2, from the covariance of the two pixels; the calibration is taken as exact
  std::uint32_t match = 0;     ///< index of its match
};

struct Rejected {
  std::size_t epipolar = 0;  ///< rays miss each other by more than the gate
  std::size_t depth = 0;     ///< behind a view, beyond `max_depth_m`, or rays (nearly) parallel
  std::size_t isolated = 0;  ///< fewer than two of 5 x 5 panel neighbours at its depth: a wrong match
};

struct Cloud {
  std::vector<CloudPoint> points;
  Rejected rejected;
};

struct TriangulateOptions {
  double epipolar_gate_px = 1.5;  ///< as the reference on the stereo set
  double max_depth_m = 20;
};

/// First-order optimal two-view triangulation: pixels move onto their epipolar lines by the least amount, weighted by
/// their covariances, then the rays meet. Errors: kTooFewMatches (fewer than 100 points left).
Result<Cloud> triangulate(const TwoViews& views, std::span<const Match> matches, std::span<const RayPair> rays,
                          const TriangulateOptions& options = {});

/// One match, without any test but this: no value where its rays are parallel or meet behind a view.
std::optional<CloudPoint> triangulate_one(const TwoViews& views, const Match& match, const RayPair& rays);

}  // namespace raysteer::calib::scene
