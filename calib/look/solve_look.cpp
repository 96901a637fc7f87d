#include "calib/look/solve_look.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>

#include "calib/look/board_plane.hpp"
#include "calib/solve/closed_form.hpp"

namespace raysteer::calib::look {
namespace {

using Delta = Eigen::Matrix<double, kUnknowns, 1>;

/// Places that miss the common solution by more than this, px per coordinate, belong to another world.
constexpr double kMostMissPx = 0.5;

/// A corner of the board or a disc in one camera.
struct Measurement {
  const Sight* sight = nullptr;
  bool disc = false;
  Eigen::Vector2d place;  ///< corner: on the plane, metres; disc: on the panel, px
  Eigen::Vector2d q;      ///< measured, camera px
  double sigma_px = 1;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  ///< disc: middle of its light minus image of its middle
  bool kept = true;
};

std::optional<Eigen::Vector2d> seen(const Solution& at, const Sight& sight, const Eigen::Vector2d& on_plane) {
  return sight.camera.project(sight.T_camera_rig * (at.T_rig_plane * Eigen::Vector3d(on_plane.x(), on_plane.y(), 0)));
}

/// Whitened; no value behind a device.
std::optional<Eigen::Vector2d> residual(const Solution& at, const Measurement& m) {
  const auto p = m.disc ? at.panel.on_plane(m.place) : std::optional(m.place);
  const auto q = p ? seen(at, *m.sight, *p) : std::nullopt;
  return q ? std::optional<Eigen::Vector2d>((*q + m.shift - m.q) / m.sigma_px) : std::nullopt;
}

/// Where the middle of a disc's light lies against the image of its middle: perspective and lenses magnify one side
/// more than the other (algorithms 1.1, point 6). Exact but for the sampling: the mean over the camera's area.
Eigen::Vector2d light_shift(const Solution& at, const Sight& sight, const Eigen::Vector2d& x, double radius) {
  constexpr int kSide = 15;
  constexpr double kStep = 0.25;  // px on the panel, for the area that one panel pixel has in the camera
  const auto through = [&](const Eigen::Vector2d& panel) -> std::optional<Eigen::Vector2d> {
    const auto p = at.panel.on_plane(panel);
    return p ? seen(at, sight, *p) : std::nullopt;
  };
  const auto middle = through(x);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Eigen::Vector2d offset = (Eigen::Vector2d(i + 0.5, j + 0.5) * 2 / kSide - Eigen::Vector2d::Ones());
      if (offset.norm() > 1) {
        continue;
      }
      const Eigen::Vector2d here = x + radius * offset;
      const auto q = through(here);
      const auto right = through(here + Eigen::Vector2d(kStep, 0));
      const auto down = through(here + Eigen::Vector2d(0, kStep));
      if (q && right && down) {
        const Eigen::Vector2d a = *right - *q;
        const Eigen::Vector2d b = *down - *q;
        const double weight = std::abs(a.x() * b.y() - a.y() * b.x());
        sum += weight * *q;
        area += weight;
      }
    }
  }
  return middle && area > 0 ? Eigen::Vector2d(sum / area - *middle) : Eigen::Vector2d(Eigen::Vector2d::Zero());
}

/// Lens unknowns against the drawing, whitened.
Eigen::Matrix<double, 8, 1> prior_residual(const model::Camera& lens, const model::Camera& drawing,
                                           const LensPrior& prior) {
  Eigen::Matrix<double, 8, 1> r;
  // Both focal lengths move together by `focal`, against each other by `aspect`.
  r << std::log(lens.fx * lens.fy / (drawing.fx * drawing.fy)) / (2 * prior.focal),
      std::log(lens.fx / lens.fy * drawing.fy / drawing.fx) / prior.aspect,
      (lens.cx - drawing.cx) / (prior.centre * drawing.fx), (lens.cy - drawing.cy) / (prior.centre * drawing.fy),
      (lens.k[0] - drawing.k[0]) / prior.radial, (lens.k[1] - drawing.k[1]) / prior.radial,
      (lens.k[2] - drawing.k[2]) / prior.tangential, (lens.k[3] - drawing.k[3]) / prior.tangential;
  return r;
}

class Problem {
 public:
  Problem(const Input& input, bool mirrored)
      : input_(input), drawing_(mirrored ? model::flipped(input.drawing) : input.drawing) {
    for (const Sight& sight : input.sights) {
      for (const target::Corner& corner : sight.corners) {
        measurements_.push_back({.sight = &sight,
                                 .disc = false,
                                 .place = target::corner_position(input.target, corner.id).head<2>(),
                                 .q = corner.q,
                                 .sigma_px = std::max(corner.sigma_px, 0.01)});
      }
      for (const target::Disc& disc : sight.discs) {
        measurements_.push_back({.sight = &sight,
                                 .disc = true,
                                 .place = input.grid.centre(disc.id),
                                 .q = disc.q,
                                 .sigma_px = disc.sigma_px});
      }
    }
  }

  const model::Camera& drawing() const { return drawing_; }
  std::vector<Measurement>& measurements() { return measurements_; }

  /// Levenberg-Marquardt from `at`. False when it does not converge.
  bool minimise(Solution& at) {
    double lambda = 1e-6;
    auto r = residuals(at);
    if (!r) {
      return false;
    }
    for (int iteration = 0; iteration < 60; ++iteration) {
      const Eigen::MatrixXd J = jacobian(at);
      const Covariance normal = J.transpose() * J;
      const Delta gradient = J.transpose() * *r;
      bool better = false;
      for (int attempt = 0; attempt < 12 && !better; ++attempt) {
        Covariance damped = normal;
        damped.diagonal() *= 1 + lambda;
        const Delta step = -damped.ldlt().solve(gradient);
        const Solution trial = perturbed(at, step);
        const auto trial_r = residuals(trial);
        if (trial_r && trial_r->squaredNorm() <= r->squaredNorm()) {
          const double gain = r->squaredNorm() - trial_r->squaredNorm();
          better = true;
          at = trial;
          r = trial_r;
          lambda = std::max(1e-9, lambda / 10);
          if (gain < 1e-7 * (1 + r->squaredNorm())) {
            return true;
          }
        } else {
          lambda *= 10;
        }
      }
      if (!better) {
        return true;  // as low as rounding lets it go
      }
    }
    return false;
  }

  void correct_shifts(const Solution& at) {
    for (Measurement& m : measurements_) {
      if (m.disc) {
        m.shift = light_shift(at, *m.sight, m.place, input_.grid.radius_px);
      }
    }
  }

  /// Widens sigmas of corners and of discs to what they were found to miss by (never narrows them), then leaves out
  /// what is farther off than 4 sigma. kLookNotSolved when they miss by so much that it is no noise, or a quarter of
  /// them disagrees with the rest.
  Status reweigh(const Solution& at) {
    std::size_t left_out = 0;
    for (const bool disc : {false, true}) {
      std::vector<double> sizes;
      for (const Measurement& m : measurements_) {
        if (m.disc == disc) {
          const auto r = residual(at, m);
          sizes.push_back(r ? r->norm() : 1e9);
        }
      }
      if (sizes.empty()) {
        continue;
      }
      const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
      std::ranges::nth_element(sizes, middle);
      const double scale = std::max(1.0, *middle / 1.1774);  // median of a Rayleigh variable of sigma 1
      for (Measurement& m : measurements_) {
        if (m.disc == disc) {
          m.sigma_px *= scale;
          const auto r = residual(at, m);
          m.kept = r && r->norm() < 4.3;  // one in ten thousand in two dimensions
          left_out += m.kept ? 0 : 1;
          if (m.sigma_px > kMostMissPx) {
            return fail(RCode::kLookNotSolved, std::string(disc ? "discs miss" : "corners of the board miss") +
                                                   " the common solution by more than half a pixel");
          }
        }
      }
    }
    if (4 * left_out > measurements_.size()) {
      return fail(RCode::kLookNotSolved, std::to_string(left_out) + " of " + std::to_string(measurements_.size()) +
                                             " corners and discs disagree with the rest");
    }
    return ok();
  }

  void finish(Solution& at) const {
    const Eigen::MatrixXd J = jacobian(at);
    const Covariance normal = J.transpose() * J;
    at.covariance = normal.ldlt().solve(Covariance::Identity());
    double corner_squares = 0, disc_squares = 0, plane_squares = 0;
    int disc_sights = 0;
    std::map<Eigen::Index, int> unused;
    std::map<std::pair<double, double>, int> discs;
    Eigen::Index row = 0;
    for (const Measurement& m : measurements_) {
      if (!m.kept) {
        ++at.left_out;
        continue;
      }
      const Eigen::Vector2d r = *residual(at, m);
      if (m.disc) {
        disc_squares += (r * m.sigma_px).squaredNorm();
        ++disc_sights;
        ++discs[{m.place.x(), m.place.y()}];
        // What the solution without it would miss it by: r / (1 - leverage).
        const auto rows = J.middleRows(row, 2);
        const Eigen::Matrix2d leverage = rows * at.covariance * rows.transpose();
        const Eigen::Vector2d alone = (Eigen::Matrix2d::Identity() - leverage).inverse() * r * m.sigma_px;
        plane_squares += on_plane(at, m, alone).squaredNorm();
      } else {
        corner_squares += (r * m.sigma_px).squaredNorm();
        ++at.corners;
      }
      row += 2;
    }
    at.discs = static_cast<int>(discs.size());
    at.corner_rms_px = std::sqrt(corner_squares / std::max(1, 2 * at.corners));
    at.disc_rms_px = std::sqrt(disc_squares / std::max(1, 2 * disc_sights));
    at.leave_one_out_mm = 1e3 * std::sqrt(plane_squares / std::max(1, disc_sights));
  }

  /// How far the solution moves when `moved` stand for the cameras, one sight each: a Gauss-Newton step.
  Delta response(const Solution& at, const std::vector<Sight>& moved) const {
    const auto before = residuals(at);
    Problem other = *this;
    for (Measurement& m : other.measurements_) {
      m.sight = &moved[static_cast<std::size_t>(m.sight - input_.sights.data())];
    }
    const auto after = other.residuals(at);
    return before && after ? Delta(-at.covariance * (jacobian(at).transpose() * (*after - *before)))
                           : Delta(Delta::Zero());
  }

 private:
  /// A step in the camera's picture as a step on the plane, metres.
  static Eigen::Vector2d on_plane(const Solution& at, const Measurement& m, const Eigen::Vector2d& step) {
    const model::Pose T_camera_plane = m.sight->T_camera_rig * at.T_rig_plane;
    const auto from = model::on_plane(m.sight->camera, T_camera_plane, m.q);
    const auto to = model::on_plane(m.sight->camera, T_camera_plane, m.q + step);
    return from && to ? Eigen::Vector2d(*to - *from) : Eigen::Vector2d(Eigen::Vector2d::Zero());
  }

  Eigen::Index rows() const { return 2 * std::ranges::count(measurements_, true, &Measurement::kept) + 8; }

  std::optional<Eigen::VectorXd> residuals(const Solution& at) const {
    Eigen::VectorXd all(rows());
    Eigen::Index row = 0;
    for (const Measurement& m : measurements_) {
      if (m.kept) {
        const auto r = residual(at, m);
        if (!r) {
          return std::nullopt;
        }
        all.segment<2>(row) = *r;
        row += 2;
      }
    }
    all.tail<8>() = prior_residual(at.panel.lens, drawing_, input_.prior);
    return all.allFinite() ? std::optional(all) : std::nullopt;
  }

  /// By central differences: 20 unknowns and some hundred residuals take milliseconds, and there is nothing to get
  /// wrong by hand. Rows that cannot be evaluated are zero.
  Eigen::MatrixXd jacobian(const Solution& at) const {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows(), kUnknowns);
    for (int i = 0; i < kUnknowns; ++i) {
      const double step = i < 12 ? 1e-6 : i < 16 ? 1e-3 : 1e-6;
      const auto up = residuals(perturbed(at, step * Delta::Unit(i)));
      const auto down = residuals(perturbed(at, -step * Delta::Unit(i)));
      if (up && down) {
        J.col(i) = (*up - *down) / (2 * step);
      }
    }
    return J;
  }

  const Input& input_;
  model::Camera drawing_;
  std::vector<Measurement> measurements_;
};

/// The projector's pose from the discs of one eye; finds out whether it is mirrored.
std::optional<model::PanelOnPlane> panel_start(const Input& input, const Sight& sight, const model::Pose& T_rig_plane) {
  const model::Pose T_camera_plane = sight.T_camera_rig * T_rig_plane;
  std::vector<Eigen::Vector2d> places, panel;
  for (const target::Disc& disc : sight.discs) {
    const auto p = model::on_plane(sight.camera, T_camera_plane, disc.q);
    if (p && input.drawing.normalize(input.grid.centre(disc.id))) {
      places.push_back(*p);
      panel.push_back(input.grid.centre(disc.id));
    }
  }
  if (places.size() < 6) {
    return std::nullopt;
  }
  for (const bool mirrored : {false, true}) {
    model::PanelOnPlane start;
    start.lens = mirrored ? model::flipped(input.drawing) : input.drawing;
    start.mirrored = mirrored;
    std::vector<Eigen::Vector2d> normalised;
    for (const Eigen::Vector2d& x : panel) {
      normalised.push_back(start.lens.normalize(start.counted(x)).value_or(Eigen::Vector2d::Zero()));
    }
    auto H = solve::homography(places, normalised);
    if (!H) {
      return std::nullopt;
    }
    // The scale's sign puts the discs before the projector; the plane's back faces it then, unless it is mirrored.
    if (H->row(2).dot(places.front().homogeneous()) < 0) {
      *H = -*H;
    }
    if (H->determinant() > 0) {
      start.T_projector_plane = solve::plane_pose(*H, 1, Eigen::Vector2d::Zero());
      return start;
    }
  }
  return std::nullopt;
}

}  // namespace

Solution perturbed(const Solution& solution, const Eigen::Matrix<double, kUnknowns, 1>& delta) {
  Solution moved = solution;
  moved.T_rig_plane = model::moved_by(solution.T_rig_plane, delta.segment<6>(0));
  moved.panel.T_projector_plane = model::moved_by(solution.panel.T_projector_plane, delta.segment<6>(6));
  model::Camera& lens = moved.panel.lens;
  lens.fx += delta[12];
  lens.fy += delta[13];
  lens.cx += delta[14];
  lens.cy += delta[15];
  for (int i = 0; i < 4; ++i) {
    lens.k[static_cast<std::size_t>(i)] += delta[16 + i];
  }
  return moved;
}

Covariance with_cameras(const Input& input, const Solution& solution, const model::Rig& rig) {
  Problem problem(input, solution.panel.mirrored);
  problem.correct_shifts(solution);
  static_cast<void>(problem.reweigh(solution));
  Covariance sum = solution.covariance;
  // Along the principal axes of what the cameras' calibration leaves open.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(rig.covariance);
  for (Eigen::Index i = 0; i < rig.covariance.rows(); ++i) {
    if (axes.eigenvalues()[i] <= 0) {
      continue;
    }
    const Eigen::VectorXd step = std::sqrt(axes.eigenvalues()[i]) * axes.eigenvectors().col(i);
    std::vector<Sight> moved = input.sights;
    for (std::size_t d = 0; d < moved.size() && d < rig.devices.size(); ++d) {
      const model::Device device = model::perturbed(rig.devices[d], step.segment(rig.offset(d), rig.count(d)), d > 0);
      moved[d].camera = device.camera;
      moved[d].T_camera_rig = device.T_device_rig;
    }
    const Delta delta = problem.response(solution, moved);
    sum += delta * delta.transpose();
  }
  return sum;
}

Result<Solution> solve_look(const Input& input) {
  Solution solution;
  bool started = false;
  for (const Sight& sight : input.sights) {
    const auto plane = plane_start(input.target, sight);
    const auto panel = plane ? panel_start(input, sight, *plane) : std::nullopt;
    if (panel) {
      solution.T_rig_plane = *plane;
      solution.panel = *panel;
      started = true;
      break;
    }
  }
  if (!started) {
    return fail(RCode::kTooFewCorrespondences, "no camera sees both 6 corners of the board and 6 discs");
  }
  Problem problem(input, solution.panel.mirrored);
  // The drawing's lens first, then discs where their light's middle is, then without what disagrees.
  for (int round = 0; round < 3; ++round) {
    if (!problem.minimise(solution)) {
      return fail(RCode::kLookNotSolved, "the adjustment does not settle");
    }
    problem.correct_shifts(solution);
    if (round == 1) {
      RAYSTEER_TRY(problem.reweigh(solution));
    }
  }
  if (!problem.minimise(solution)) {
    return fail(RCode::kLookNotSolved, "the adjustment does not settle");
  }
  problem.finish(solution);
  return solution;
}

}  // namespace raysteer::calib::look
