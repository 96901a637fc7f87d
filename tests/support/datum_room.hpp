// A room with datums on its floor, a rig somewhere above it, and what its eyes see: the truth that calib/datum is
// tested against.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "calib/datum/tie.hpp"
#include "hal/base/datum_code.hpp"

namespace raysteer::support {

struct DatumRoom {
  calib::model::Rig solved;       ///< the cameras as somebody calibrated them, with covariance
  calib::model::Rig true_rig;     ///< as they are
  Eigen::VectorXd camera_errors;  ///< true minus solved
  calib::model::Pose T_room_rig;
  proto::survey::Survey survey;         ///< off by its own sigma
  std::vector<Eigen::Vector3d> p_room;  ///< where the datums truly are
  double pixel_sigma = 0.015;

  /// What both eyes see now.
  calib::datum::View look(std::mt19937_64& random, const std::string& name = "look") const {
    std::normal_distribution<double> normal;
    calib::datum::View view{.name = name, .eyes = {}};
    for (std::size_t i = 0; i < p_room.size(); ++i) {
      const proto::survey::Vec3& n = survey.datums[i].normal;
      const Eigen::Vector3d face = T_room_rig.q.conjugate() * Eigen::Vector3d(n[0], n[1], n[2]);
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const calib::model::Device& device = true_rig.devices[eye];
        const auto q =
            calib::target::ellipse_middle(device.camera, device.T_device_rig * (T_room_rig.inverse() * p_room[i]),
                                          device.T_device_rig.q * face, survey.datums[i].radius_m);
        calib::target::SeenDatum seen;
        seen.code = survey.datums[i].code;
        seen.q = q.value_or(Eigen::Vector2d::Zero()) + pixel_sigma * Eigen::Vector2d(normal(random), normal(random));
        seen.cov = pixel_sigma * pixel_sigma * Eigen::Matrix2d::Identity();
        seen.shape = 12 * Eigen::Matrix2d::Identity();
        view.eyes[eye].push_back(seen);
      }
    }
    return view;
  }
};

inline calib::model::Rig drawn_eyes() {
  calib::model::Rig rig;
  for (const char* name : {"left", "right"}) {
    calib::model::Device eye;
    eye.name = name;
    eye.camera = {.width = 2448, .height = 2048, .fx = 1400, .fy = 1400, .cx = 1223.5, .cy = 1023.5, .k = {-0.03}};
    rig.devices.push_back(eye);
  }
  rig.devices[1].T_device_rig.t = {-0.5, 0, 0};
  return rig;
}

/// `count` datums round the floor below the rig, irregularly, 1.2 to 2 m from its middle; cameras off by what a good
/// calibration leaves, correlated at random; a survey of 0.3 mm.
inline DatumRoom datum_room(std::mt19937_64& random, int count) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> any(-1, 1);
  DatumRoom room;
  room.solved = drawn_eyes();
  const int parameters = room.solved.offset(1) + room.solved.count(1);
  Eigen::VectorXd sigma(parameters);
  sigma << 0.3, 0.3, 0.3, 0.3, 1e-4, 1e-4, 1e-5, 1e-5, 0.3, 0.3, 0.3, 0.3, 1e-4, 1e-4, 1e-5, 1e-5, 2e-5, 2e-5, 4e-5,
      1e-4, 1e-4, 1e-4;
  Eigen::MatrixXd mix = Eigen::MatrixXd::Identity(parameters, parameters);
  Eigen::VectorXd deviates(parameters);
  for (int i = 0; i < parameters; ++i) {
    deviates(i) = normal(random);
    for (int j = 0; j < i; ++j) {
      mix(i, j) = 0.3 * any(random);
    }
  }
  Eigen::MatrixXd spread = sigma.asDiagonal() * mix;
  // Principal points are known far worse than what both eyes see of one board: turning the right eye makes up for them.
  const int right = room.solved.offset(1);
  const int turn = right + 8;
  spread.row(turn) -= (spread.row(3) - spread.row(right + 3)) / 1400;
  spread.row(turn + 1) += (spread.row(2) - spread.row(right + 2)) / 1400;
  room.solved.covariance = spread * spread.transpose();
  room.camera_errors = spread * deviates;
  room.true_rig = room.solved;
  for (std::size_t i = 0; i < 2; ++i) {
    room.true_rig.devices[i] = calib::model::perturbed(
        room.solved.devices[i], room.camera_errors.segment(room.solved.offset(i), room.solved.count(i)), i > 0);
  }
  room.T_room_rig = {calib::model::rotation_by({0.03 * any(random), 0.03 * any(random), 3 * any(random)}) *
                         calib::model::rotation_by({std::numbers::pi, 0, 0}),
                     {any(random), any(random), 3.5}};
  room.survey.name = "room";
  for (int k = 0; k < count; ++k) {
    const double around = 2 * std::numbers::pi * (k + 0.35 * any(random)) / count;
    const double reach = 1.6 + 0.4 * any(random);
    const Eigen::Vector3d p =
        room.T_room_rig * Eigen::Vector3d(0.25 + reach * std::cos(around), reach * std::sin(around), 3.5);
    room.p_room.emplace_back(p.x(), p.y(), 0);
    const double survey_sigma = 0.3e-3;
    const auto off = [&] { return survey_sigma * normal(random); };
    room.survey.datums.push_back({.name = "datum " + std::to_string(k + 1),
                                  .code = datum_codes()[static_cast<std::size_t>(k)],
                                  .radius_m = 0.03,
                                  .position_m = {p.x() + off(), p.y() + off(), off()},
                                  .normal = {0, 0, 1},
                                  .sigma_mm = 1e3 * survey_sigma});
  }
  return room;
}

}  // namespace raysteer::support
