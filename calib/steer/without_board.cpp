#include "calib/steer/without_board.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "calib/steer/depth.hpp"
#include "calib/steer/eye_points.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr int kElsewhere = 3;        // starts near the drawing, until one fits
constexpr double kApart = 4;         // joint standard deviations of a focal length
constexpr double kApartForSure = 3;  // standard deviations of a mount: closer eyes may as well stand in one place

struct Measured {
  double metres = 0;
  double variance = 0;  ///< of what both eyes saw of its ends
};

/// The known length in the cameras' metres; no value where an eye does not see an end.
std::optional<Measured> measured(const model::Rig& cameras, const KnownLength& known) {
  if (!known.ends) {
    return Measured{.metres = cameras.devices[1].T_device_rig.t.norm()};
  }
  const Eigen::MatrixXd held = Eigen::MatrixXd::Zero(cameras.count(0) + cameras.count(1), 0);
  const Eyes eyes(cameras, held);
  const auto a = eyes.see((*known.ends)[0]);
  const auto b = eyes.see((*known.ends)[1]);
  if (!a || !b) {
    return std::nullopt;
  }
  const Eigen::Vector3d along = (b->p - a->p).normalized();
  return Measured{.metres = (b->p - a->p).norm(), .variance = along.dot((a->covariance + b->covariance) * along)};
}

Status check(const KnownLength& known) {
  if (!std::isfinite(known.metres) || !std::isfinite(known.sigma_m)) {
    return fail(RCode::kNotFinite, "the known length is not a number");
  }
  if (!(known.metres > 0) || !(known.sigma_m > 0)) {
    return fail(RCode::kBadValue, "expected a known length and its standard deviation above zero, got " +
                                      std::to_string(known.metres) + " and " + std::to_string(known.sigma_m) + " m");
  }
  return ok();
}

/// Looks of which even the drawn cameras see enough: of a few points at a picture's rim hardly one may be left.
std::vector<Look> seen_by(const Observations& drawn) {
  const Eigen::MatrixXd held = Eigen::MatrixXd::Zero(drawn.cameras.count(0) + drawn.cameras.count(1), 0);
  const Eyes eyes(drawn.cameras, held);
  std::vector<Look> looks;
  for (const Look& look : drawn.looks) {
    const auto seen = std::ranges::count_if(look.points, [&](const LitPoint& p) { return eyes.see(p).has_value(); });
    if (static_cast<std::size_t>(seen) >= 2 * kFewestPoints) {
      looks.push_back(look);
    }
  }
  return looks;
}

/// Every start that fits must lead to the same cameras: one from elsewhere is tried, with few points.
Status check_alone(const Solution& solution, const Observations& observations, const Drawing& drawing,
                   const Options& options) {
  Observations few{.cameras = observations.cameras, .looks = {}};
  for (const Look& look : observations.looks) {
    few.looks.push_back(look);
    auto& points = few.looks.back().points;
    const std::size_t step = points.size() / static_cast<std::size_t>(options.starting_points) + 1;
    points.clear();
    for (std::size_t i = 0; i < look.points.size(); i += step) {
      points.push_back(look.points[i]);
    }
  }
  Options elsewhere = options;
  elsewhere.first_start = 1;
  elsewhere.starts = kElsewhere;
  const auto other = solve(few, drawing, elsewhere);
  for (std::size_t i = 0; other && i < 2; ++i) {
    const double f = solution.cameras.devices[i].camera.fx;
    const double apart = std::abs(other->cameras.devices[i].camera.fx - f);
    const int at = solution.cameras.offset(i);
    if (apart > kApart * std::sqrt(other->covariance(at, at) + solution.covariance(at, at))) {
      return fail(RCode::kRigNotSolved, "two different rigs fit: from another start camera '" +
                                            solution.cameras.devices[i].name + "' has " +
                                            std::to_string(other->cameras.devices[i].camera.fx) + " px instead of " +
                                            std::to_string(f) + "; add looks, or give --cameras a calibration");
    }
  }
  return ok();
}

/// Not where the input itself is at fault.
bool cause_may_be_depth(RCode code) {
  return code == RCode::kRigNotSolved || code == RCode::kDrawingsDisagree || code == RCode::kTooFewCorrespondences;
}

}  // namespace

model::Rig drawn_cameras(const model::Rig& drawn, const Tolerance& tolerance, double along_m) {
  model::Rig rig = drawn;
  const int all = rig.count(0) + rig.count(1);
  rig.covariance = Eigen::MatrixXd::Zero(all, all);
  rig.parameters.clear();
  for (std::size_t i = 0; i < 2; ++i) {
    const model::Device& eye = rig.devices[i];
    auto block = rig.covariance.block(rig.offset(i), rig.offset(i), rig.count(i), rig.count(i));
    // The focal lengths go together; against each other they are as square as pixels are.
    const double f = eye.camera.fx;
    block.topLeftCorner<2, 2>().setConstant(std::pow(tolerance.focal * f, 2));
    block.diagonal().head<2>().array() += std::pow(tolerance.aspect * f, 2) / 2;
    block.diagonal().segment<2>(2).setConstant(std::pow(tolerance.centre * f, 2));
    const int terms = model::coefficients(eye.camera.lens);
    block.diagonal().segment(4, terms).setConstant(std::pow(tolerance.distortion, 2));
    block.diagonal().segment<2>(6).setConstant(std::pow(tolerance.tangential, 2));
    if (i > 0) {
      const Eigen::Vector3d along = eye.T_device_rig.t.normalized();
      const double across = tolerance.mount_m * tolerance.mount_m;
      block.diagonal().segment<3>(4 + terms).setConstant(tolerance.mount_rad * tolerance.mount_rad);
      block.bottomRightCorner<3, 3>() =
          across * Eigen::Matrix3d::Identity() + (along_m * along_m - across) * along * along.transpose();
    }
    for (const char* name : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"}) {
      if (static_cast<int>(rig.parameters.size()) < rig.offset(i) + 4 + terms) {
        rig.parameters.push_back(eye.name + "." + name);
      }
    }
    if (i > 0) {
      for (const char* name : {"rx", "ry", "rz", "tx", "ty", "tz"}) {
        rig.parameters.push_back(eye.name + "." + name);
      }
    }
  }
  return rig;
}

Result<Solution> solve_without_board(const Observations& drawn, const Drawing& drawing,
                                     const std::optional<KnownLength>& known, const Options& options) {
  if (drawn.cameras.devices.size() != 2) {
    return fail(RCode::kCameraCount, "expected two cameras, got " + std::to_string(drawn.cameras.devices.size()));
  }
  if (known) {
    RAYSTEER_TRY(check(*known));
  }
  const double apart = drawn.cameras.devices[1].T_device_rig.t.norm();
  if (!(apart > kApartForSure * drawing.tolerance.mount_m)) {
    return fail(RCode::kTooLittleParallax, "the eyes are drawn " + std::to_string(1e3 * apart) + " mm apart, each to " +
                                               std::to_string(1e3 * drawing.tolerance.mount_m) +
                                               " mm: mount them farther apart, or give --cameras a calibration");
  }
  Observations observations{.cameras = drawn_cameras(drawn.cameras, drawing.tolerance, drawing.tolerance.mount_m),
                            .looks = seen_by(drawn)};
  // Mistakes are looked for with calibrated cameras only.
  Options open = options;
  open.open_cameras = true;
  open.explain = false;
  auto solution = solve(observations, drawing, open);
  if (!solution) {
    if (cause_may_be_depth(solution.error().rcode)) {
      RAYSTEER_TRY(check_depth(depth_of(drawn.looks, drawn.cameras)));
    }
    return solution;
  }
  RAYSTEER_TRY(check_depth(depth_of(drawn.looks, solution->cameras, std::max(1.0, solution->whitened_rms)), *solution));
  RAYSTEER_TRY(check_alone(*solution, observations, drawing, open));
  if (!known) {
    return solution;
  }
  // The length is put in through the distance between the eyes, about the cameras as they came out: where the right
  // eye really stands is known by then, so that the distance is one number along one direction.
  const auto first = measured(solution->cameras, *known);
  if (!first) {
    return fail(RCode::kTooFewCorrespondences, "both eyes do not see both ends of the known length");
  }
  const double scale = known->metres / first->metres;
  const double sigma = std::hypot(known->sigma_m, scale * std::sqrt(first->variance)) / known->metres;
  model::Pose& right = observations.cameras.devices[1].T_device_rig;
  right.t = scale * solution->cameras.devices[1].T_device_rig.t;
  observations.cameras = drawn_cameras(observations.cameras, drawing.tolerance, sigma * right.t.norm());
  return solve(observations, drawing, open);
}

}  // namespace raysteer::calib::steer
