#include "calib/scene/two_views.hpp"

#include <limits>
#include <optional>

namespace raysteer::calib::scene {

Result<TwoViews> two_views(const model::Rig& rig, std::size_t left, std::size_t right) {
  if (left >= rig.devices.size() || right >= rig.devices.size()) {
    return fail(RCode::kCalibrationMismatch,
                "the calibration has " + std::to_string(rig.devices.size()) + " device(s)");
  }
  const model::Device& a = rig.devices[left];
  const model::Device& b = rig.devices[right];
  TwoViews views{a.camera, b.camera, b.T_device_rig * a.T_device_rig.inverse()};
  if (!(views.T_right_left.t.norm() > 1e-6)) {
    return fail(RCode::kBadCalibrationFile, "'" + a.name + "' and '" + b.name + "' stand at the same place");
  }
  return views;
}

std::vector<RayPair> ray_pairs(const TwoViews& views, std::span<const Match> matches) {
  const Eigen::Vector2d none = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  std::vector<RayPair> rays;
  rays.reserve(matches.size());
  for (const Match& match : matches) {
    rays.push_back(
        {views.left.normalize(match.q_left).value_or(none), views.right.normalize(match.q_right).value_or(none)});
  }
  return rays;
}

}  // namespace raysteer::calib::scene
