// pure: the boards in boards/ as read, as drawings and as drawn cameras.
#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "tests/support/ideal_rig.hpp"
#include "tests/support/paths.hpp"

namespace raysteer::support {

struct DrawnRig {
  proto::board::Board board;
  calib::steer::Drawing drawing;
  calib::model::Rig cameras;  ///< as drawn, without covariance
};

inline DrawnRig drawn_rig(const std::string& name) {
  const auto path = source_root() / "boards" / (name + ".toml");
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  auto board = proto::board::read_board(text.str(), path.filename().string());
  if (!board) {
    throw std::runtime_error(board.error().message());
  }
  DrawnRig rig{.board = *std::move(board), .drawing = {}, .cameras = {}};
  rig.drawing = drawing_of(rig.board);
  for (const proto::board::Camera& camera : rig.board.cameras) {
    const auto vector = [](const proto::board::Vec3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
    calib::model::Device device{.name = camera.name, .kind = calib::model::DeviceKind::kCamera, .camera = {}};
    device.camera = {.width = camera.width,
                     .height = camera.height,
                     .fx = camera.lens.focal_px,
                     .fy = camera.lens.focal_px,
                     .cx = camera.lens.centre_px[0],
                     .cy = camera.lens.centre_px[1]};
    std::ranges::copy(camera.lens.distortion, device.camera.k.begin());
    device.T_device_rig = {calib::model::rotation_by(vector(camera.T_camera_rig.rotation)),
                           vector(camera.T_camera_rig.translation)};
    rig.cameras.devices.push_back(device);
  }
  return rig;
}

}  // namespace raysteer::support
