#include "calib/steer/check.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/steer/solve.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr std::size_t kFewestLooks = 6;
constexpr std::size_t kFewestLevels = 4;

bool is_covariance(const Eigen::Matrix2d& c, bool may_be_zero) {
  if (may_be_zero && c.isZero(0)) {
    return true;
  }
  return c(0, 0) > 0 && c(1, 1) > 0 && std::abs(c(0, 1) - c(1, 0)) <= 1e-9 * c.trace() && c.determinant() > 0;
}

/// Commands apart by more than a fiftieth of the axis's range count as two.
std::size_t levels(const Observations& observations, int axis, double range) {
  std::vector<double> values;
  for (const Look& look : observations.looks) {
    values.push_back(look.command_rad[axis]);
  }
  std::ranges::sort(values);
  std::size_t count = 1;
  double last = values.front();
  for (const double value : values) {
    if (value - last > range / 50) {
      ++count;
      last = value;
    }
  }
  return count;
}

Status check_feedback(const Observations& observations, const Drawing& drawing) {
  for (int axis = 0; axis < 2; ++axis) {
    const double half = drawing.projector.curves[static_cast<std::size_t>(axis)].half_range;
    // A sensor's own offset and gain error pass: 1 mrad and 2 % of the half range.
    const double allowed = 1e-3 + 0.02 * half;
    for (const Look& look : observations.looks) {
      if (!look.feedback_rad) {
        continue;
      }
      if (!look.feedback_rad->allFinite()) {
        return fail(RCode::kNotFinite, "the mirror's feedback of look '" + look.name + "' is not a number");
      }
      const double off = (*look.feedback_rad)[axis] - look.command_rad[axis];
      if (!(std::abs(off) > allowed)) {
        continue;
      }
      std::string note = "look '" + look.name + "': axis " + std::to_string(axis + 1) + " was told " +
                         std::to_string(1e3 * look.command_rad[axis]) + " mrad and its sensor said " +
                         std::to_string(1e3 * (*look.feedback_rad)[axis]) + "; expected no more than " +
                         std::to_string(1e3 * allowed) + " mrad apart";
      for (const Look& other : observations.looks) {
        if (&other != &look && (other.command_rad - *look.feedback_rad).norm() < allowed / 4) {
          note += "; it is the command of look '" + other.name + "': are the looks in order?";
          break;
        }
      }
      return fail(RCode::kFeedbackDisagrees, note);
    }
  }
  return ok();
}

Status check_cameras(const model::Rig& cameras) {
  if (cameras.devices.size() != 2) {
    return fail(RCode::kCameraCount, "expected two cameras, got " + std::to_string(cameras.devices.size()));
  }
  for (const model::Device& device : cameras.devices) {
    RAYSTEER_TRY(model::check(device.camera));
    if (!device.T_device_rig.t.allFinite() || !device.T_device_rig.q.coeffs().allFinite()) {
      return fail(RCode::kNotFinite, "the pose of camera '" + device.name + "' is not a number");
    }
  }
  const Eigen::Index expected = cameras.count(0) + cameras.count(1);
  if (cameras.covariance.rows() != expected || cameras.covariance.cols() != expected) {
    return fail(RCode::kBadValue, "expected the cameras' covariance with " + std::to_string(expected) +
                                      " rows and columns, got " + std::to_string(cameras.covariance.rows()) + " x " +
                                      std::to_string(cameras.covariance.cols()));
  }
  if (!cameras.covariance.allFinite()) {
    return fail(RCode::kNotFinite, "the cameras' covariance has entries that are not numbers");
  }
  if (cameras.devices[1].T_device_rig.t.norm() < 1e-3) {
    return fail(RCode::kBadValue, "the cameras stand in one place: expected a baseline");
  }
  return ok();
}

Status check_drawing(const Drawing& drawing) {
  RAYSTEER_TRY(model::check(drawing.projector.lens));
  const Tolerance& t = drawing.tolerance;
  for (const double value :
       {t.axis_rad, t.position_m, t.zero_rad, t.gain, t.quadratic, t.cubic, t.cross_talk, t.focal, t.aspect, t.centre,
        t.distortion, t.tangential, t.mount_rad, t.mount_m, t.repeatability_rad}) {
    if (!(value > 0) || !std::isfinite(value)) {
      return fail(RCode::kBadValue, "expected every tolerance of the drawing above zero, got " + std::to_string(value));
    }
  }
  if (drawing.projector.lens.lens != model::LensModel::kBc4) {
    return fail(RCode::kBadValue, "expected the projector's lens as 'bc4'");
  }
  return ok();
}

}  // namespace

Status check(const Look& look) {
  if (!look.command_rad.allFinite()) {
    return fail(RCode::kNotFinite, "the command of look '" + look.name + "' is not a number");
  }
  if (look.points.size() < kFewestPoints) {
    return fail(RCode::kTooFewCorrespondences, "look '" + look.name + "' has " + std::to_string(look.points.size()) +
                                                   " points; expected at least " + std::to_string(kFewestPoints));
  }
  for (std::size_t i = 0; i < look.points.size(); ++i) {
    const LitPoint& point = look.points[i];
    if (!point.x.allFinite() || !point.q[0].allFinite() || !point.q[1].allFinite() || !point.cov_x.allFinite() ||
        !point.cov_q[0].allFinite() || !point.cov_q[1].allFinite()) {
      return fail(RCode::kNotFinite, "point " + std::to_string(i) + " of look '" + look.name + "' is not a number");
    }
    if (!is_covariance(point.cov_x, true) || !is_covariance(point.cov_q[0], false) ||
        !is_covariance(point.cov_q[1], false)) {
      return fail(RCode::kBadValue, "point " + std::to_string(i) + " of look '" + look.name +
                                        "' has a covariance that is none: expected symmetric and positive");
    }
  }
  return ok();
}

Status check(const Observations& observations, const Drawing& drawing) {
  RAYSTEER_TRY(check_cameras(observations.cameras));
  RAYSTEER_TRY(check_drawing(drawing));
  if (observations.looks.size() < kFewestLooks) {
    return fail(RCode::kTooFewLooks, "got " + std::to_string(observations.looks.size()) + " looks; expected at least " +
                                         std::to_string(kFewestLooks) + ", better 16");
  }
  for (const Look& look : observations.looks) {
    RAYSTEER_TRY(check(look));
  }
  for (int axis = 0; axis < 2; ++axis) {
    const double range = drawing.projector.most_rad[axis] - drawing.projector.least_rad[axis];
    const std::size_t count = levels(observations, axis, range);
    if (count < kFewestLevels) {
      return fail(RCode::kTooFewLooks, "the looks have " + std::to_string(count) + " distinct levels of axis " +
                                           std::to_string(axis + 1) + "; expected at least " +
                                           std::to_string(kFewestLevels) +
                                           ": gain and curvature cannot be told apart with fewer");
    }
  }
  return check_feedback(observations, drawing);
}

}  // namespace raysteer::calib::steer
