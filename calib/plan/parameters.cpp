#include "calib/plan/parameters.hpp"

#include "hal/base/result.hpp"

namespace raysteer::calib::plan {
namespace {

/// Takes a vector apart from its front.
class Reader {
 public:
  explicit Reader(const Eigen::VectorXd& values) : values_(values) {}
  double next(double sigma) { return sigma * values_[at_++]; }
  Eigen::Vector3d next3(double sigma) {
    at_ += 3;
    return sigma * values_.segment<3>(at_ - 3);
  }
  /// A shift by two numbers in the plane across `direction`.
  Eigen::Vector3d across(const Eigen::Vector3d& direction, double sigma) {
    const Eigen::Vector3d a = direction.unitOrthogonal();
    const double first = next(sigma);
    return first * a + next(sigma) * direction.cross(a);
  }

 private:
  const Eigen::VectorXd& values_;
  Eigen::Index at_ = 0;
};

void move(model::MirrorPart& part, const steer::Tolerance& tolerance, Reader& by) {
  const model::MirrorPart drawn = part;
  part.axis = (drawn.axis + by.across(drawn.axis, tolerance.axis_rad)).normalized();
  part.point += by.across(drawn.axis, tolerance.position_m);
  // The normal: about the axis by the zero angle, and askew to it as directions are.
  const Eigen::Vector3d about = (drawn.axis - drawn.axis.dot(drawn.normal) * drawn.normal).normalized();
  const double zero = by.next(tolerance.zero_rad);
  const double tilt = by.next(tolerance.axis_rad);
  part.normal = (drawn.normal + zero * about.cross(drawn.normal) + tilt * about).normalized();
  part.offset_m += by.next(tolerance.position_m);
}

}  // namespace

int parameter_count(model::MirrorKind kind) { return 8 + 6 + (kind == model::MirrorKind::kHead ? 11 : 14) + 8; }

model::SteeredProjector moved(const steer::Drawing& drawing, const Eigen::VectorXd& sigmas) {
  RAYSTEER_CHECK(sigmas.size() == parameter_count(drawing.projector.kind));
  const steer::Tolerance& tolerance = drawing.tolerance;
  model::SteeredProjector p = drawing.projector;
  Reader by(sigmas);
  const double focal = p.lens.fx;
  p.lens.fx *= 1 + by.next(tolerance.focal);
  p.lens.fy *= p.lens.fx / focal * (1 + by.next(tolerance.aspect));
  p.lens.cx += by.next(tolerance.centre * focal);
  p.lens.cy += by.next(tolerance.centre * focal);
  p.lens.k[0] += by.next(tolerance.distortion);
  p.lens.k[1] += by.next(tolerance.distortion);
  p.lens.k[2] += by.next(tolerance.tangential);
  p.lens.k[3] += by.next(tolerance.tangential);
  Eigen::Matrix<double, 6, 1> mount;
  mount << by.next3(tolerance.mount_rad), by.next3(tolerance.mount_m);
  p.T_projector_rig = model::moved_by(p.T_projector_rig, mount);
  move(p.parts[0], tolerance, by);
  if (p.kind == model::MirrorKind::kHead) {
    const Eigen::Vector3d drawn = p.outer_axis;
    p.outer_axis = (drawn + by.across(drawn, tolerance.axis_rad)).normalized();
    p.outer_point += by.across(drawn, tolerance.position_m);
  } else {
    move(p.parts[1], tolerance, by);
  }
  for (model::CommandCurve& curve : p.curves) {
    curve.gain += by.next(tolerance.gain);
    curve.quadratic += by.next(tolerance.quadratic);
    curve.cubic += by.next(tolerance.cubic);
    curve.cross_talk += by.next(tolerance.cross_talk);
  }
  return p;
}

}  // namespace raysteer::calib::plan
