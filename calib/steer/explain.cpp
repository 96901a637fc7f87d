#include "calib/steer/explain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "calib/steer/prior.hpp"

namespace raysteer::calib::steer {
namespace {

constexpr int kSearchPoints = 20;  // per look: mistakes are far from subtle

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

std::string quoted(const std::string& name) { return "'" + name + "'"; }

Attempt try_out(const Observations& observations, const Drawing& drawing, const Options& options,
                const Selection& selection = {.points_per_look = kSearchPoints},
                std::optional<std::size_t> split = std::nullopt, const State* near = nullptr) {
  const Eigen::MatrixXd by_z = camera_prior(observations.cameras);
  auto problem = build(observations, drawing, by_z, Eigen::VectorXd::Zero(by_z.cols()), selection);
  if (!problem) {
    return {};
  }
  problem->split = split;
  State start = start_of(*problem);
  if (near != nullptr) {
    start.projector = near->projector;
  }
  // From the drawing looks may be sacrificed; from near by none may, or two of them hide a bump.
  return attempt(*problem, std::move(start), options, near == nullptr);
}

/// How commands may reach the mirror otherwise than the board file says.
struct Wiring {
  bool exchanged = false;
  bool by_share = false;  ///< exchanged as shares of the half ranges, not as angles
  std::array<bool, 2> reversed{};

  Eigen::Vector2d command(Eigen::Vector2d c, const model::SteeredProjector& p) const {
    if (exchanged) {
      const double ratio = by_share ? p.curves[0].half_range / p.curves[1].half_range : 1;
      c = {c.y() * ratio, c.x() / ratio};
    }
    return {reversed[0] ? -c.x() : c.x(), reversed[1] ? -c.y() : c.y()};
  }
  std::string say() const {
    std::string text;
    if (exchanged) {
      text = "the mirror's axes are exchanged";
    }
    for (std::size_t k = 0; k < 2; ++k) {
      if (reversed[k]) {
        text += (text.empty() ? "" : " and ") + std::string("axis ") + std::to_string(k + 1) + " is reversed";
      }
    }
    return text;
  }
};

struct Flip {
  bool columns = false;
  bool rows = false;
};

Observations rewired(Observations observations, const model::SteeredProjector& p, const Wiring& wiring,
                     const Flip& flip) {
  for (Look& look : observations.looks) {
    look.command_rad = wiring.command(look.command_rad, p);
    for (LitPoint& point : look.points) {
      if (flip.columns) {
        point.x.x() = p.lens.width - 1 - point.x.x();
        point.cov_x(0, 1) = point.cov_x(1, 0) = -point.cov_x(0, 1);
      }
      if (flip.rows) {
        point.x.y() = p.lens.height - 1 - point.x.y();
        point.cov_x(0, 1) = point.cov_x(1, 0) = -point.cov_x(0, 1);
      }
    }
  }
  return observations;
}

/// Few points of each look: searches copy them.
Observations thinned(const Observations& observations) {
  Observations few{.cameras = observations.cameras, .looks = {}};
  for (const Look& look : observations.looks) {
    few.looks.push_back({look.name, look.command_rad, look.feedback_rad, {}});
    const std::size_t n = std::min<std::size_t>(look.points.size(), kSearchPoints);
    for (std::size_t i = 0; i < n; ++i) {
      few.looks.back().points.push_back(look.points[i * look.points.size() / n]);
    }
  }
  return few;
}

std::optional<Error> wiring_or_picture(const Observations& few, const Drawing& drawing, const Options& options) {
  const model::SteeredProjector& p = drawing.projector;
  const bool shares = std::abs(p.curves[0].half_range / p.curves[1].half_range - 1) > 0.01;
  std::vector<Wiring> wirings;
  for (const int exchange : {0, 1, 2}) {
    for (const int reversed : {0, 1, 2, 3}) {
      if (exchange < 2 || shares) {
        wirings.push_back({.exchanged = exchange > 0,
                           .by_share = exchange == 2,
                           .reversed = {(reversed & 1) != 0, (reversed & 2) != 0}});
      }
    }
  }
  for (const Flip& flip : {Flip{false, false}, Flip{true, false}, Flip{false, true}, Flip{true, true}}) {
    const bool flipped = flip.columns || flip.rows;
    for (const Wiring& wiring : wirings) {
      if (!flipped && wiring.say().empty()) {
        continue;
      }
      const Attempt attempt = try_out(rewired(few, p, wiring, flip), drawing, options);
      if (!attempt.fits_all()) {
        continue;
      }
      const std::string axes = wiring.say();
      if (flipped) {
        return fail(RCode::kPictureMirrored, std::string("everything fits once the picture is flipped ") +
                                                 (flip.columns && flip.rows ? "left to right and top to bottom"
                                                  : flip.columns            ? "left to right"
                                                                            : "top to bottom") +
                                                 (axes.empty() ? "" : ", and " + axes) +
                                                 "; switch the flip off in the projector's menu");
      }
      return fail(RCode::kAxisReversed,
                  "everything fits if " + axes + "; change the wiring, or the board file: " +
                      (wiring.exchanged ? "exchange its axes" : "turn the sign of that axis' direction") +
                      ", then capture again or correct the commands of the looks");
    }
  }
  return std::nullopt;
}

Error rig_moved(const Observations& observations, std::size_t split, const Attempt& attempt) {
  const auto moved = attempt.state.moved;
  // Rotation counts by what it does 3.5 m away.
  const auto far = [](const auto& pose) {
    return 3.5 * pose.template head<3>().norm() + pose.template tail<3>().norm();
  };
  const bool projector = far(moved.head<6>()) >= far(moved.tail<6>());
  const Eigen::Matrix<double, 6, 1> most = projector ? moved.head<6>() : moved.tail<6>();
  return fail(RCode::kRigMoved,
              "between looks " + quoted(observations.looks[split - 1].name) + " and " +
                  quoted(observations.looks[split].name) + ": " +
                  (projector ? "projector and mirror" : "the right camera") + " turned by " +
                  number(1e3 * most.head<3>().norm()) + " mrad and shifted by " + number(1e3 * most.tail<3>().norm()) +
                  " mm against the left camera",
              static_cast<std::int64_t>(split));
}

struct Split {
  std::size_t before = 0;
  Attempt attempt;
};

/// The best place for a bump: both sides need looks enough to tell.
/// `near`: what the looks came to without a bump; the second start of each split.
std::optional<Split> best_split(const Observations& few, const Drawing& drawing, const Options& options,
                                const State* near = nullptr) {
  std::optional<Split> best;
  for (std::size_t split = 2; split + 2 <= few.looks.size(); ++split) {
    Attempt attempt = try_out(few, drawing, options, {.points_per_look = kSearchPoints}, split);
    if (near != nullptr && !attempt.fits_all()) {
      attempt = try_out(few, drawing, options, {.points_per_look = kSearchPoints}, split, near);
    }
    // Where both sides fit, latents tell which split leaves the least to them.
    const auto worse = [&](const Attempt& a, const Attempt& b) {
      return a.repeatability_rad * a.fit.rms > b.repeatability_rad * b.fit.rms;
    };
    if (attempt.fits_all() && (!best || worse(best->attempt, attempt))) {
      best = Split{split, std::move(attempt)};
    }
  }
  return best;
}

/// The look whose command a foreign look's frames belong to, if there is one.
std::string belongs_to(const Observations& observations, const Problem& problem, const State& state,
                       std::size_t foreign) {
  double best = 10;  // whitened
  std::string name;
  for (const Look& other : observations.looks) {
    if (&other == &observations.looks[foreign]) {
      continue;
    }
    const model::SteeredLook look(state.projector, other.command_rad);
    std::vector<double> off;
    for (const ProblemPoint& point : problem.looks[foreign].points) {
      const auto r = residual(problem, state, foreign, point, look);
      off.push_back(r ? r->panel.norm() : 1e9);
    }
    const auto middle = off.begin() + static_cast<std::ptrdiff_t>(off.size() / 2);
    std::nth_element(off.begin(), middle, off.end());
    if (*middle < best) {
      best = *middle;
      name = other.name;
    }
  }
  return name;
}

Error look_foreign(const Observations& few, const Drawing& drawing, const Attempt& attempt) {
  const Eigen::MatrixXd by_z = camera_prior(few.cameras);
  auto problem = build(few, drawing, by_z, Eigen::VectorXd::Zero(by_z.cols()));
  std::string note;
  for (const std::size_t k : attempt.fit.foreign) {
    note += (note.empty() ? "" : ", ") + std::string("look ") + quoted(few.looks[k].name);
    if (problem) {
      whiten(*problem, attempt.state);
      const std::string other = belongs_to(few, *problem, attempt.state, k);
      note += other.empty() ? "" : " (its frames fit the command of look " + quoted(other) + ")";
    }
  }
  return fail(RCode::kLookForeign, note + "; the other looks agree with each other",
              static_cast<std::int64_t>(attempt.fit.foreign.front()));
}

std::optional<Error> one_look(const Observations& few, const Drawing& drawing, const Options& options,
                              double repeatability_rad) {
  double best = repeatability_rad;
  std::optional<std::size_t> which;
  std::optional<Attempt> several;  // without look k the others fit, but for some
  for (std::size_t k = 0; k < few.looks.size(); ++k) {
    Selection others{.points_per_look = kSearchPoints, .left_out = std::vector<bool>(few.looks.size(), false)};
    others.left_out[k] = true;
    const Attempt attempt = try_out(few, drawing, options, others);
    if (attempt.fits_all() && attempt.repeatability_rad < best) {
      best = attempt.repeatability_rad;
      which = k;
    } else if (attempt.fits && !attempt.fits_all() &&
               (!several || attempt.fit.foreign.size() + 1 < several->fit.foreign.size())) {
      several = attempt;
      for (std::size_t& other : several->fit.foreign) {
        other += other >= k ? 1 : 0;
      }
      several->fit.foreign.push_back(k);
      std::ranges::sort(several->fit.foreign);
      several->state.latents.insert(several->state.latents.begin() + static_cast<std::ptrdiff_t>(k),
                                    Eigen::Vector2d::Zero());
    }
  }
  if (!which && several && std::isinf(repeatability_rad) && 4 * several->fit.foreign.size() <= few.looks.size()) {
    return look_foreign(few, drawing, *several);
  }
  if (!which) {
    return std::nullopt;
  }
  return fail(
      RCode::kLookForeign,
      "look " + quoted(few.looks[*which].name) + "; without it the mirror repeats to " + number(1e6 * best) + " urad",
      static_cast<std::int64_t>(*which));
}

}  // namespace

Error why_not(const Observations& observations, const Drawing& drawing, const Options& options, const Attempt& best) {
  const std::string plain = "whitened residuals are " + number(best.fit.rms) + ", expected at most " +
                            number(options.most_whitened_rms) + ", with the mirror repeating to " +
                            number(1e6 * best.repeatability_rad) + " urad";
  if (!options.explain) {
    return fail(RCode::kRigNotSolved, plain);
  }
  const Observations few = thinned(observations);
  if (best.fits && !best.fit.foreign.empty()) {
    // One look beside a mirror that repeats as stated is plain. Otherwise a bump may explain more.
    if (best.fit.foreign.size() > 1 || best.repeatability_rad > 2.5 * drawing.tolerance.repeatability_rad) {
      if (auto split = best_split(few, drawing, options, &best.state)) {
        return rig_moved(few, split->before, split->attempt);
      }
    }
    return look_foreign(few, drawing, best);
  }
  // Wiring and flips put points hundreds of pixels off, a bump some: the likelier first.
  const bool far_off = best.fit.rms > 50;
  for (const bool wiring : {far_off, !far_off}) {
    if (wiring) {
      if (auto reason = wiring_or_picture(few, drawing, options)) {
        return *std::move(reason);
      }
    } else if (auto split = best_split(few, drawing, options, &best.state)) {
      return rig_moved(few, split->before, split->attempt);
    }
  }
  if (auto reason = one_look(few, drawing, options, std::numeric_limits<double>::infinity())) {
    return *std::move(reason);
  }
  Options any = options;
  any.foreign_drawing_sigma = std::numeric_limits<double>::infinity();
  Drawing loose = drawing;
  Tolerance& t = loose.tolerance;
  for (double* value :
       {&t.axis_rad, &t.position_m, &t.zero_rad, &t.gain, &t.focal, &t.centre, &t.mount_rad, &t.mount_m}) {
    *value *= 5;
  }
  if (const Attempt attempt = try_out(few, loose, any); attempt.fits_all()) {
    const Eigen::VectorXd off = prior_residuals(drawing, prior_sigma(drawing), attempt.state.projector);
    Eigen::Index worst = 0;
    const double sigmas = off.cwiseAbs().maxCoeff(&worst);
    return fail(RCode::kDrawingsDisagree,
                quoted(model::steered_parameter_names(drawing.projector.kind)[static_cast<std::size_t>(worst)]) +
                    " would have to be " + number(sigmas) + " tolerances away from the board file");
  }
  return fail(RCode::kRigNotSolved, plain);
}

std::optional<Error> why_scattered(const Observations& observations, const Drawing& drawing, const Options& options,
                                   double repeatability_rad) {
  const Observations few = thinned(observations);
  // A sixteenth of the looks, or six more numbers, take away a tenth of the scatter; a mistake takes nearly all of it.
  constexpr double kExplained = 0.35;
  if (auto reason = one_look(few, drawing, options, kExplained * repeatability_rad)) {
    return reason;
  }
  if (auto split = best_split(few, drawing, options);
      split && split->attempt.repeatability_rad < kExplained * repeatability_rad) {
    return rig_moved(few, split->before, split->attempt);
  }
  return std::nullopt;
}

}  // namespace raysteer::calib::steer
