// value: solved devices in one frame, and how sure we are of them.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "calib/model/camera.hpp"
#include "calib/model/pose.hpp"

namespace raysteer::calib::model {

enum class DeviceKind { kCamera, kProjector };

struct Device {
  std::string name;
  DeviceKind kind = DeviceKind::kCamera;
  Camera camera;
  Pose T_device_rig{};  ///< identity for the first device: the rig's frame is the first camera's
};

/// Devices with the joint covariance of all their parameters.
///
/// Order of `covariance` and `parameters`: device by device, fx fy cx cy, the lens's coefficients, then (all but the
/// first device) rotation (3, radians, left increment: R = exp([w]) R0) and translation (3, metres). Parameters held
/// fixed have zero rows and columns.
struct Rig {
  std::vector<Device> devices;
  std::vector<std::string> parameters;  ///< "left.fx", "right.rx", ...
  Eigen::MatrixXd covariance;

  const Device* find(std::string_view name) const;
  /// Index of the first parameter of device i, and how many it has.
  int offset(std::size_t device) const;
  int count(std::size_t device) const;
};

/// Parameters of a device in the order above (the rotation increment is zero).
Eigen::VectorXd parameters(const Device& device, bool with_pose);
/// A device moved by `delta` in the order above.
Device perturbed(const Device& device, const Eigen::VectorXd& delta, bool with_pose);

}  // namespace raysteer::calib::model
