// value: what the devices saw of one calibration target, view by view; everything a solve starts from.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/target/target_geometry.hpp"
#include "hal/base/target.hpp"

namespace raysteer::calib::solve {

/// A camera or the projector before its lens is known.
struct DeviceInfo {
  std::string name;
  model::DeviceKind kind = model::DeviceKind::kCamera;
  int width = 0;   ///< px
  int height = 0;  ///< px
};

/// A camera pixel on the target and the projector coordinate decoded there.
struct DecodedPixel {
  int camera = 0;       ///< index into Observations::devices
  Eigen::Vector2d q;    ///< camera px
  Eigen::Vector2d x;    ///< projector px
  double sigma_px = 0;  ///< of x, per coordinate
};

/// One position of the target.
struct View {
  std::string name;                                  ///< what the user calls it: "pose_3", "12"
  std::vector<std::vector<target::Corner>> corners;  ///< per device; empty: this device did not see the target.
                                                     ///< For the projector: the panel px that lights the corner.
  std::vector<DecodedPixel> pixels;                  ///< with a projector; between the corners
};

/// Views in the order they were taken. The first device is a camera and carries the rig's frame.
struct Observations {
  TargetSpec target;
  std::vector<DeviceInfo> devices;
  std::vector<View> views;

  /// Index of the projector in `devices`, or -1.
  int projector() const;
};

}  // namespace raysteer::calib::solve
