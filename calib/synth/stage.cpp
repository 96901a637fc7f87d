#include "calib/synth/stage.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "calib/synth/noise.hpp"
#include "calib/synth/observations.hpp"

namespace raysteer::calib::synth {
namespace {

/// Corners stay this share of the width inside, so that the outermost squares and some margin are seen too.
constexpr double kMargin = 0.06;

model::Pose turned(double rx, double ry, double rz, const Eigen::Vector3d& t) {
  model::Pose pose;
  pose.q = Eigen::AngleAxisd(ry, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(rx, Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(rz, Eigen::Vector3d::UnitZ());
  pose.t = t;
  return pose;
}

model::Camera pretend_camera(Noise& noise, double scale) {
  model::Camera camera;
  camera.width = static_cast<int>(640 * scale);
  camera.height = static_cast<int>(512 * scale);
  camera.fx = 800 * scale * noise.uniform(0.97, 1.03);
  camera.fy = camera.fx * noise.uniform(0.998, 1.002);
  camera.cx = 320 * scale + noise.uniform(-8, 8) * scale;
  camera.cy = 256 * scale + noise.uniform(-8, 8) * scale;
  camera.lens = model::LensModel::kBc4;
  camera.k = {noise.uniform(-0.14, -0.08), noise.uniform(0.05, 0.1), noise.uniform(-1e-3, 1e-3),
              noise.uniform(-1e-3, 1e-3)};
  return camera;
}

/// Looks at the same target from views that every device in `rig` sees whole.
void show_target(Stage& stage, const model::Rig& rig, const std::vector<Sensor>& sensors, const TargetPlan& plan,
                 std::uint64_t seed) {
  stage.target = pretend_target();
  const auto print = std::make_shared<const Print>(stage.target);
  for (const model::Pose& pose : target_poses(rig, stage.target, plan, seed)) {
    const std::string number = std::to_string(stage.looks.size());
    StagedLook look{"view_" + std::string(number.size() < 2 ? "0" : "") + number, {}, sensors};
    look.scene.plates.push_back(target_plate(pose, print, 0.02));
    look.scene.plates.push_back(plate(turned(0, 0, 0, {0, 0, 1.8}), 6, 6, 0.3));  // the far wall of the room
    stage.looks.push_back(std::move(look));
  }
}

}  // namespace

model::Rig PretendRig::rig() const {
  model::Rig all;
  constexpr const char* kNames[] = {"left", "right"};
  for (std::size_t i = 0; i < sensors.size(); ++i) {
    all.devices.push_back({kNames[i], model::DeviceKind::kCamera, sensors[i].camera, sensors[i].T_camera_rig});
  }
  all.devices.push_back({"projector", model::DeviceKind::kProjector, lamp.panel, lamp.T_projector_rig});
  return all;
}

PretendRig pretend_rig(std::uint64_t seed, double scale) {
  Noise noise(seed, 0x716);
  const auto about = [&](double value, double spread) { return value + noise.uniform(-spread, spread); };
  PretendRig pretend;
  pretend.sensors.resize(2);
  for (Sensor& sensor : pretend.sensors) {
    sensor.camera = pretend_camera(noise, scale);
    sensor.gain = 180;
  }
  // Right stands to the right and is turned inwards, so that both look at one place 0.95 m away.
  pretend.sensors[1].T_camera_rig =
      turned(about(0, 0.01), about(-0.21, 0.01), about(0, 0.01), {about(0.2, 0.01), about(0, 0.005), about(0, 0.005)})
          .inverse();
  Lamp& lamp = pretend.lamp;
  lamp.panel.width = static_cast<int>(640 * scale);
  lamp.panel.height = static_cast<int>(400 * scale);
  lamp.panel.fx = 700 * scale * about(1, 0.03);
  lamp.panel.fy = lamp.panel.fx * about(1, 0.002);
  lamp.panel.cx = 320 * scale + about(0, 10) * scale;
  lamp.panel.cy = 430 * scale + about(0, 15) * scale;
  lamp.panel.k = {about(-0.04, 0.01), about(0.01, 0.005), about(0, 5e-4), about(0, 5e-4)};
  lamp.T_projector_rig =
      turned(about(0, 0.01), about(-0.11, 0.01), about(0, 0.01), {about(0.1, 0.01), about(0.3, 0.01), 0}).inverse();
  return pretend;
}

TargetSpec pretend_target() {
  TargetSpec target;
  target.kind = TargetKind::kChessboard;
  target.columns = 9;
  target.rows = 6;
  target.square_m = 0.03;
  return target;
}

PatternSequence half_period_sequence(int panel_width, int panel_height, bool complement, int steps) {
  constexpr double kPeriod = 16;
  PatternSequence sequence{panel_width, panel_height, {}};
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    const int length = axis == Axis::kX ? panel_width : panel_height;
    PatternBlock gray;
    gray.kind = PatternKind::kGray;
    gray.axis = axis;
    gray.stripe_px = kPeriod / 2;
    gray.inverse = complement;
    gray.bits = static_cast<int>(std::ceil(std::log2(length / gray.stripe_px + 1)));
    sequence.blocks.push_back(gray);
    PatternBlock phase;
    phase.kind = PatternKind::kPhase;
    phase.axis = axis;
    phase.steps = steps;
    phase.period_px = kPeriod;
    phase.origin_px = -0.5;  // periods begin at the panel's edge, as the Gray stripes do
    sequence.blocks.push_back(phase);
  }
  sequence.blocks.emplace_back().kind = PatternKind::kWhite;
  sequence.blocks.emplace_back().kind = PatternKind::kBlack;
  return sequence;
}

Stage cameras_stage(const PretendRig& pretend, std::uint64_t seed, int views) {
  Stage stage;
  stage.name = "rendered-cameras";
  stage.cameras = {"left", "right"};
  stage.lamp = pretend.lamp;
  stage.ambient = 1.1;  // room light: the projector lights only a part of the pictures
  stage.lamp.power = 0;
  stage.sequence = {pretend.lamp.panel.width, pretend.lamp.panel.height, {}};
  stage.sequence.blocks.emplace_back().kind = PatternKind::kWhite;
  show_target(stage, pretend.rig(), pretend.sensors,
              {.views = views, .distance_m = 0.75, .margin_px = kMargin * pretend.sensors[0].camera.width}, seed);
  return stage;
}

Stage projector_stage(const PretendRig& pretend, std::uint64_t seed, int views) {
  Stage stage;
  stage.name = "rendered-projector";
  stage.cameras = {"left"};
  stage.lamp = pretend.lamp;
  stage.lamp.power = 0.55;  // white paper 0.64 m away stays below saturation
  stage.sequence = half_period_sequence(pretend.lamp.panel.width, pretend.lamp.panel.height, false);
  model::Rig rig = pretend.rig();
  rig.devices.erase(rig.devices.begin() + 1);
  show_target(
      stage, rig, {pretend.sensors.front()},
      {.views = views, .distance_m = 0.8, .margin_px = kMargin * pretend.sensors[0].camera.width, .on_panel = true},
      seed + 1);
  return stage;
}

Stage scan_stage(const PretendRig& pretend, std::uint64_t seed) {
  Noise noise(seed, 0x5ca);
  const auto about = [&](double value, double spread) { return value + noise.uniform(-spread, spread); };
  Stage stage;
  stage.name = "rendered-scan";
  stage.cameras = {"left", "right"};
  stage.lamp = pretend.lamp;
  stage.sequence = half_period_sequence(pretend.lamp.panel.width, pretend.lamp.panel.height, true);
  StagedLook look{"look_0", {}, pretend.sensors};
  look.scene.plates.push_back(plate(turned(about(0, 0.1), about(0.1, 0.1), 0, {0, 0, 1.0}), 3, 3, 0.75));
  add_box(look.scene, turned(about(0.1, 0.1), about(0.3, 0.2), 0, {about(0.1, 0.02), about(0.08, 0.02), 0.93}),
          {0.16, 0.12, 0.1}, 0.6);
  look.scene.balls.push_back({{about(-0.1, 0.02), about(-0.05, 0.02), 0.92}, about(0.07, 0.01), 0.65});
  stage.looks.push_back(std::move(look));
  return stage;
}

}  // namespace raysteer::calib::synth
