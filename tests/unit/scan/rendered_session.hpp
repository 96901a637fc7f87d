// A small session rendered from a known rig and scene, on disk for as long as the object lives.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/synth/render.hpp"
#include "calib/synth/scene.hpp"
#include "host/session/image_codec.hpp"
#include "host/session/session.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::host::scan {

/// Two cameras 0.2 m apart and a projector between them.
inline calib::model::Rig small_rig() {
  using calib::model::DeviceKind;
  calib::model::Camera camera{.width = 240, .height = 180, .fx = 300, .fy = 300, .cx = 119.5, .cy = 89.5};
  calib::model::Camera panel{.width = 128, .height = 96, .fx = 200, .fy = 200, .cx = 63.5, .cy = 47.5};
  calib::model::Rig rig;
  rig.devices = {{"left", DeviceKind::kCamera, camera, {}},
                 {"right", DeviceKind::kCamera, camera, {}},
                 {"projector", DeviceKind::kProjector, panel, {}}};
  rig.devices[1].T_device_rig = {Eigen::Quaterniond(Eigen::AngleAxisd(0.15, -Eigen::Vector3d::UnitY())),
                                 {-0.2, 0, 0.01}};
  rig.devices[2].T_device_rig = {Eigen::Quaterniond(Eigen::AngleAxisd(0.08, -Eigen::Vector3d::UnitY())),
                                 {-0.1, 0.06, 0}};
  return rig;
}

/// A tilted wall and a box before it.
inline calib::synth::Scene small_scene() {
  calib::synth::Scene scene;
  scene.plates.push_back(calib::synth::plate(
      {Eigen::Quaterniond(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY())), {0.1, 0, 1.1}}, 2, 2, 0.7));
  calib::synth::add_box(scene, {Eigen::Quaterniond::Identity(), {0.12, 0.05, 0.95}}, {0.1, 0.1, 0.1}, 0.6);
  return scene;
}

inline PatternSequence small_sequence() {
  PatternSequence sequence;
  sequence.panel_width = 128;
  sequence.panel_height = 96;
  sequence.blocks.push_back({.kind = PatternKind::kWhite});
  sequence.blocks.push_back({.kind = PatternKind::kBlack});
  sequence.blocks.push_back({.kind = PatternKind::kGray, .axis = Axis::kX, .bits = 7, .inverse = true});
  sequence.blocks.push_back({.kind = PatternKind::kGray, .axis = Axis::kY, .bits = 7, .inverse = true});
  return sequence;
}

class RenderedSession {
 public:
  /// `cameras`: devices of `rig` to render, in the order and under the names of the session.
  RenderedSession(const calib::model::Rig& rig, const std::vector<std::pair<std::size_t, std::string>>& cameras)
      : folder_(std::filesystem::temp_directory_path() /
                ("raysteer-scan-" + std::to_string(getpid()) + "-" +
                 testing::UnitTest::GetInstance()->current_test_info()->name() + std::to_string(cameras.size()))) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    proto::session::Manifest manifest;
    manifest.name = "small";
    manifest.sequence = small_sequence();
    manifest.looks = {{.name = "only"}};
    const calib::model::Device& projector = rig.devices[2];
    const calib::synth::Lamp lamp{.panel = projector.camera, .T_projector_rig = projector.T_device_rig};
    const std::vector<Pattern> patterns = manifest.sequence.patterns();
    std::uint32_t number = 0;
    for (const auto& [device, name] : cameras) {
      const calib::synth::Sensor sensor{.camera = rig.devices[device].camera,
                                        .T_camera_rig = rig.devices[device].T_device_rig};
      manifest.cameras.push_back({.name = name, .files = name + "_{index:02}.pgm"});
      const calib::synth::View view(small_scene(), sensor, &lamp, 0.05, 1);
      for (std::uint32_t k = 0; k < patterns.size(); ++k) {
        const Image<std::uint8_t> frame =
            view.frame<std::uint8_t>(patterns[k], {.seed = 5, .camera = number, .frame = k});
        write(proto::session::file_name(manifest, manifest.cameras.back(), manifest.looks[0], static_cast<int>(k)),
              session::encode_pgm(frame.view()));
      }
      ++number;
    }
    const std::string text = proto::session::write_manifest(manifest);
    write("session.toml", {text.begin(), text.end()});
  }
  ~RenderedSession() { std::filesystem::remove_all(folder_); }
  RenderedSession(const RenderedSession&) = delete;
  RenderedSession& operator=(const RenderedSession&) = delete;

  session::Session open() const {
    Result<session::Session> session = session::Session::open(folder_ / "session.toml");
    EXPECT_TRUE(session) << session.error().message();
    return *std::move(session);
  }

 private:
  void write(const std::string& name, const std::vector<std::uint8_t>& bytes) const {
    const Status written = session::write_file(folder_ / name, bytes);
    EXPECT_TRUE(written);
  }

  std::filesystem::path folder_;
};

}  // namespace raysteer::host::scan
