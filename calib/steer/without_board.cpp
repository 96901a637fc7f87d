#include "calib/steer/without_board.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "calib/steer/check.hpp"
#include "calib/steer/depth.hpp"
#include "calib/steer/eye_points.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr int kElsewhere = 3;        // starts near the drawing, until one fits
constexpr double kApart = 4;         // joint standard deviations of a focal length
constexpr double kSeen = 0.6;        // share of a look's points that drawn cameras must see
constexpr double kMostOff = 5;       // standard deviations of a mount that a known length may move an eye by
constexpr double kApartForSure = 3;  // standard deviations of a mount: closer eyes may as well stand in one place

/// The known length in the cameras' metres, and what it is off by where the cameras are.
struct Measured {
  double metres = 0;
  double variance = 0;  ///< of what both eyes saw of its ends
  Eigen::RowVectorXd by_cameras;
};

/// No value where an eye does not see an end.
std::optional<Measured> measured(const model::Rig& cameras, const KnownLength& known) {
  const Eigen::Index n = cameras.count(0) + cameras.count(1);
  if (!known.ends) {
    const Eigen::Vector3d& t = cameras.devices[1].T_device_rig.t;
    Measured apart{.metres = t.norm(), .by_cameras = Eigen::RowVectorXd::Zero(n)};
    apart.by_cameras.tail<3>() = t.normalized().transpose();
    return apart;
  }
  const Eigen::MatrixXd each = Eigen::MatrixXd::Identity(n, n);
  const Eyes eyes(cameras, each);
  std::array<LitPoint, 2> ends = *known.ends;
  for (LitPoint& end : ends) {
    for (Eigen::Matrix2d& covariance : end.cov_q) {
      covariance.diagonal().array() += known.ends_off_px * known.ends_off_px;
    }
  }
  const auto a = eyes.see(ends[0]);
  const auto b = eyes.see(ends[1]);
  if (!a || !b) {
    return std::nullopt;
  }
  const Eigen::RowVector3d along = (b->p - a->p).normalized().transpose();
  return Measured{.metres = (b->p - a->p).norm(),
                  .variance = along.dot((a->covariance + b->covariance) * along.transpose()),
                  .by_cameras = along * (b->p_by_z - a->p_by_z)};
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

/// Looks of which even the drawn cameras see enough: of a few points at a picture's rim hardly one may be left, and
/// starts try a part of the points only.
std::vector<Look> seen_by(const Observations& drawn, std::vector<std::string>& left_out) {
  const Eigen::MatrixXd held = Eigen::MatrixXd::Zero(drawn.cameras.count(0) + drawn.cameras.count(1), 0);
  const Eyes eyes(drawn.cameras, held);
  std::vector<Look> looks;
  for (const Look& look : drawn.looks) {
    const auto seen = std::ranges::count_if(look.points, [&](const LitPoint& p) { return eyes.see(p).has_value(); });
    const auto share = static_cast<double>(seen) / static_cast<double>(std::max<std::size_t>(1, look.points.size()));
    if (static_cast<std::size_t>(seen) >= 2 * kFewestPoints && share >= kSeen) {
      looks.push_back(look);
    } else {
      left_out.push_back(look.name);
    }
  }
  return looks;
}

/// The looks with the points that the solve did not take for mistakes; it keeps their order.
std::vector<Look> kept(const std::vector<Look>& looks, const Solution& solution) {
  std::vector<Look> kept;
  for (const SolvedLook& solved : solution.looks) {
    const auto look = std::ranges::find(looks, solved.name, &Look::name);
    kept.push_back(*look);
    kept.back().points.clear();
    auto residual = solved.points.begin();
    for (const LitPoint& point : look->points) {
      if (residual != solved.points.end() && residual->x == point.x) {
        if (residual->used) {
          kept.back().points.push_back(point);
        }
        ++residual;
      }
    }
  }
  return kept;
}

std::string millimetres(double metres) {
  const std::string text = std::to_string(1e3 * metres);
  return text.substr(0, text.find('.') + 2) + " mm";
}

/// Where a length would put the eyes, and where they are drawn.
Status check_baseline(const KnownLength& known, double implied, double drawn, double mount_m) {
  if (std::abs(implied - drawn) <= kMostOff * mount_m) {
    return ok();
  }
  return fail(RCode::kScaleWrong, "a known length of " + millimetres(known.metres) + " puts the eyes " +
                                      millimetres(implied) + " apart; they are drawn " + millimetres(drawn) +
                                      " apart, to " + millimetres(mount_m) +
                                      ": is it in metres, and between the right places?");
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

model::Rig drawn_cameras(const model::Rig& drawn, const Tolerance& tolerance) {
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
      block.diagonal().segment<3>(4 + terms).setConstant(tolerance.mount_rad * tolerance.mount_rad);
      block.diagonal().tail<3>().setConstant(tolerance.mount_m * tolerance.mount_m);
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
  if (apart <= kApartForSure * drawing.tolerance.mount_m) {
    return fail(RCode::kTooLittleParallax, "the eyes are drawn " + std::to_string(1e3 * apart) + " mm apart, each to " +
                                               std::to_string(1e3 * drawing.tolerance.mount_m) +
                                               " mm: mount them farther apart, or give --cameras a calibration");
  }
  Observations observations{.cameras = drawn_cameras(drawn.cameras, drawing.tolerance), .looks = {}};
  std::vector<std::string> left_out;
  for (const Look& look : drawn.looks) {
    if (look.points.size() < kFewestPoints) {
      left_out.push_back(look.name);
    } else {
      observations.looks.push_back(look);
    }
  }
  // Before any is left out: a pixel that is no number is not seen either.
  RAYSTEER_TRY(check(observations, drawing));
  observations.looks = seen_by(observations, left_out);
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
  RAYSTEER_TRY(check_depth(
      depth_of(kept(observations.looks, *solution), solution->cameras, std::max(1.0, solution->whitened_rms)),
      *solution));
  RAYSTEER_TRY(check_alone(*solution, observations, drawing, open));
  if (!known) {
    solution->left_out = std::move(left_out);
    return solution;
  }
  // Scale alone is still off by per cents, and all else scales with it: then the length is one more measurement of the
  // cameras, linear about them, which narrows their tolerances along its own slope (a Kalman step whose mean stays).
  const auto first = measured(solution->cameras, *known);
  if (!first) {
    return fail(RCode::kTooFewCorrespondences, "both eyes do not see both ends of the known length");
  }
  model::Rig scaled = solution->cameras;
  scaled.devices[1].T_device_rig.t *= known->metres / first->metres;
  RAYSTEER_TRY(check_baseline(*known, scaled.devices[1].T_device_rig.t.norm(), apart, drawing.tolerance.mount_m));
  const auto length = measured(scaled, *known);
  if (!length) {
    return fail(RCode::kTooFewCorrespondences, "both eyes do not see both ends of the known length");
  }
  observations.cameras = drawn_cameras(scaled, drawing.tolerance);
  Eigen::MatrixXd& covariance = observations.cameras.covariance;
  const Eigen::VectorXd shared = covariance * length->by_cameras.transpose();
  const double variance = known->sigma_m * known->sigma_m + length->variance + length->by_cameras.dot(shared);
  covariance -= (shared * shared.transpose() / variance).eval();
  auto scaled_solution = solve(observations, drawing, open);
  if (scaled_solution) {
    scaled_solution->left_out = std::move(left_out);
  }
  return scaled_solution;
}

}  // namespace raysteer::calib::steer
