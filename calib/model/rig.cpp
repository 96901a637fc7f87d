#include "calib/model/rig.hpp"

#include "hal/base/result.hpp"

namespace raysteer::calib::model {

const Device* Rig::find(std::string_view name) const {
  for (const Device& device : devices) {
    if (device.name == name) {
      return &device;
    }
  }
  return nullptr;
}

int Rig::count(std::size_t device) const {
  return 4 + coefficients(devices[device].camera.lens) + (device > 0 ? 6 : 0);
}

int Rig::offset(std::size_t device) const {
  int first = 0;
  for (std::size_t i = 0; i < device; ++i) {
    first += count(i);
  }
  return first;
}

Eigen::VectorXd parameters(const Device& device, bool with_pose) {
  const Camera& camera = device.camera;
  const int lens = coefficients(camera.lens);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(4 + lens + (with_pose ? 6 : 0));
  values.head<4>() << camera.fx, camera.fy, camera.cx, camera.cy;
  for (int i = 0; i < lens; ++i) {
    values[4 + i] = camera.k[static_cast<std::size_t>(i)];
  }
  if (with_pose) {
    values.tail<3>() = device.T_device_rig.t;
  }
  return values;
}

Device perturbed(const Device& device, const Eigen::VectorXd& delta, bool with_pose) {
  const int lens = coefficients(device.camera.lens);
  RAYSTEER_CHECK(delta.size() == 4 + lens + (with_pose ? 6 : 0));
  Device moved = device;
  Camera& camera = moved.camera;
  camera.fx += delta[0];
  camera.fy += delta[1];
  camera.cx += delta[2];
  camera.cy += delta[3];
  for (int i = 0; i < lens; ++i) {
    camera.k[static_cast<std::size_t>(i)] += delta[4 + i];
  }
  if (with_pose) {
    moved.T_device_rig = moved_by(device.T_device_rig, delta.tail<6>());
  }
  return moved;
}

}  // namespace raysteer::calib::model
