// shared: the scanned surface that light meets, read from its file.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/bake/ray_caster.hpp"
#include "hal/base/result.hpp"

namespace raysteer::host::rig {

/// A place on the scanned surface, rig frame.
struct ScannedPlace {
  Eigen::Vector3d p;
  Eigen::Vector3d normal;  ///< unit
  double sigma_m = 0;      ///< of the scan along the left eye's ray
};

struct Scene {
  calib::bake::RayCaster surface;
  std::vector<float> sigma_m;  ///< of each point of the surface's mesh
  double sigma_95_m = 0;       ///< 95 % of them are below

  /// The first place on a way; nothing where the scan has none.
  std::optional<ScannedPlace> first(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const;
};

/// A surface.ply or its folder, made by 'raysteer scan --rig'. Errors: those of the file and of RayCaster;
/// kCalibrationMismatch (another calibration of the rig measured it).
Result<Scene> read_scene(const std::string& path, const std::string& rig_id);

}  // namespace raysteer::host::rig
