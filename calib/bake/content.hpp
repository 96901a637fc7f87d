// value: what a place shows: content coordinates of points in space, and the surface that light meets there.
//
// All ways of placing content are one: a 3x4 matrix takes a point to homogeneous content pixels (algorithms 6.1).
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>

#include "calib/bake/station.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::bake {

/// normal.X = distance, |normal| = 1, rig frame.
struct SurfacePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double distance_m = 0;
};

struct Content {
  std::string name;
  Eigen::Vector2i content_px{0, 0};
  /// Homogeneous content pixels of a homogeneous rig-frame point; pixel (0,0) is the middle of the top left one.
  Eigen::Matrix<double, 3, 4> content_rig = Eigen::Matrix<double, 3, 4>::Zero();
  /// What the light meets; nothing: the scanned surface.
  std::optional<SurfacePlane> plane = std::nullopt;
  double metres_per_px = 0;  ///< 0: not to scale
  double tolerance_m = 0;
};

/// To scale on the station's plane.
Content metric_content(const Station& station);
/// Draped over the scanned surface: the rectangle's picture falls along the plane's z onto what lies there, so that it
/// is to scale seen along z.
Content draped_content(const Station& station);
/// What an eye at T_eye_rig (x right, y down, z ahead) sees at `focal_px` and `centre_px`, drawn on `plane` or the
/// scanned surface: from there, and from there alone, it looks undistorted.
Content seen_content(std::string name, const model::Pose& T_eye_rig, double focal_px, const Eigen::Vector2d& centre_px,
                     const Eigen::Vector2i& content_px, const std::optional<SurfacePlane>& plane);

/// The way a content pixel is looked at: rig frame, `direction` unit.
struct Sight {
  Eigen::Vector3d origin;  ///< the eye; for content along parallel ways 50 m before the rig
  Eigen::Vector3d direction;
};
Sight sight(const Content& content, const Eigen::Vector2d& uv);

/// Errors: kBadValue (name, sizes), kNotFinite.
Status check(const Station& station);
Status check(const Content& content);

}  // namespace raysteer::calib::bake
