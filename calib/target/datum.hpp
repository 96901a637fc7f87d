// Coded ring datums: their places in a camera's frame.
//
// What a datum looks like is in hal/base/datum_code.hpp.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <vector>

#include "calib/model/camera.hpp"
#include "hal/base/datum_code.hpp"
#include "hal/base/frame.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::target {

/// A datum as one camera saw it.
struct SeenDatum {
  unsigned code = 0;      ///< one of datum_codes()
  Eigen::Vector2d q;      ///< middle of the disc's ellipse, camera px; see ellipse_middle()
  Eigen::Matrix2d cov;    ///< of q, px^2
  Eigen::Matrix2d shape;  ///< the disc's outline is q + shape * (cos, sin), px
  double margin = 0;      ///< how clearly the least clear sector is black or white: 0 not at all, 1 fully
  double contrast = 0;    ///< white minus black, grey levels

  double radius_px() const;
};

struct DatumsInFrame {
  std::vector<SeenDatum> seen;    ///< by rising code, each code once
  std::vector<unsigned> doubled;  ///< codes that were found at two places; neither is in `seen`
};

/// Datums from about 8 px of disc diameter upwards, tilted by up to 65 degrees. An empty frame has none.
DatumsInFrame detect_datums(ImageView<const std::uint8_t> frame);
DatumsInFrame detect_datums(ImageView<const std::uint16_t> frame);
DatumsInFrame detect_datums(const Frame& frame);

/// Where the middle of the ellipse is that a camera sees of a disc; the projection of the disc's centre is elsewhere by
/// about r^2 sin(tilt) cos(tilt) / f (algorithms 1.1), and by what the lens bends. `centre` and the unit `normal` are
/// in the camera's frame, metres. No value behind the camera.
std::optional<Eigen::Vector2d> ellipse_middle(const model::Camera& camera, const Eigen::Vector3d& centre,
                                              const Eigen::Vector3d& normal, double radius_m);

}  // namespace raysteer::calib::target
