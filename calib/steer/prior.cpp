#include "calib/steer/prior.hpp"

#include <cmath>

#include "calib/model/steered_parameters.hpp"

namespace raysteer::calib::steer {

Eigen::VectorXd prior_sigma(const Drawing& drawing) {
  const model::SteeredProjector& p = drawing.projector;
  const Tolerance& t = drawing.tolerance;
  Eigen::VectorXd sigma(model::steered_parameters(p.kind));
  const double f = p.lens.fx;
  sigma.head<model::kLensParameters>() << t.focal * f, t.focal * f, t.centre * f, t.centre * f, t.distortion,
      t.distortion, t.tangential, t.tangential;
  sigma.segment<3>(model::kLensParameters).setConstant(t.mount_rad);
  sigma.segment<3>(model::kLensParameters + 3).setConstant(t.mount_m);
  // Normals at rest carry the zero angle (algorithms 4.4): loose about the mirror's own axis, as stiff as an axis along
  // it. Their two tangents are at an angle to that, so both get the looser; what is lost is a weak prior.
  const double normal = std::hypot(t.zero_rad, t.axis_rad);
  auto mirror = sigma.segment(model::kLensParameters + model::kPoseParameters, model::mirror_parameters(p.kind));
  if (p.kind == model::MirrorKind::kHead) {
    mirror << t.axis_rad, t.axis_rad, t.position_m, t.position_m, t.axis_rad, t.axis_rad, t.position_m, t.position_m,
        normal, normal, t.position_m;
  } else {
    for (int k = 0; k < 2; ++k) {
      mirror.segment<7>(7 * k) << t.axis_rad, t.axis_rad, t.position_m, t.position_m, normal, normal, t.position_m;
    }
  }
  for (int k = 0; k < 2; ++k) {
    sigma.tail<model::kCurveParameters>().segment<4>(4 * k) << t.gain, t.quadratic, t.cubic, t.cross_talk;
  }
  return sigma;
}

Eigen::VectorXd prior_residuals(const Drawing& drawing, const Eigen::VectorXd& sigma,
                                const model::SteeredProjector& projector) {
  const model::Camera& drawn = drawing.projector.lens;
  const model::Camera& lens = projector.lens;
  Eigen::VectorXd residuals = model::departure(drawing.projector, projector).cwiseQuotient(sigma);
  residuals[0] = ((lens.fx + lens.fy) / (drawn.fx + drawn.fy) - 1) / drawing.tolerance.focal;
  residuals[1] = (lens.fx / lens.fy - drawn.fx / drawn.fy) / drawing.tolerance.aspect;
  return residuals;
}

Eigen::VectorXd prior_residuals(const Drawing& drawing, const Eigen::VectorXd& sigma,
                                const model::SteeredProjector& projector, Eigen::MatrixXd& by_move) {
  const Eigen::Index n = sigma.size();
  by_move.resize(n, n);
  // Differences: nearly the identity, and 72 of them cost less than one look's points.
  constexpr double kStep = 1e-4;
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::VectorXd move = kStep * sigma[k] * Eigen::VectorXd::Unit(n, k);
    by_move.col(k) = (prior_residuals(drawing, sigma, model::perturbed(projector, move)) -
                      prior_residuals(drawing, sigma, model::perturbed(projector, -move))) /
                     (2 * kStep);
  }
  return prior_residuals(drawing, sigma, projector);
}

}  // namespace raysteer::calib::steer
