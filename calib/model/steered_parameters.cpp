#include "calib/model/steered_parameters.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "hal/base/result.hpp"

namespace raysteer::calib::model {
namespace {

/// Visits the parameters one block after the other, so that moving and comparing cannot disagree about the order.
/// `direction`, `point` (with the direction of its line) and `number` are called with references into `projector`.
template <class Projector, class Direction, class Point, class Number>
void visit_mirror(Projector& projector, Direction direction, Point point, Number number) {
  if (projector.kind == MirrorKind::kHead) {
    point(projector.outer_point, projector.outer_axis, 2);
    direction(projector.outer_axis, 0);
    point(projector.parts[0].point, projector.parts[0].axis, 6);
    direction(projector.parts[0].axis, 4);
    direction(projector.parts[0].normal, 8);
    number(projector.parts[0].offset_m, 10);
    return;
  }
  for (int k = 0; k < 2; ++k) {
    auto& part = projector.parts[static_cast<std::size_t>(k)];
    point(part.point, part.axis, 7 * k + 2);
    direction(part.axis, 7 * k);
    direction(part.normal, 7 * k + 4);
    number(part.offset_m, 7 * k + 6);
  }
}

Eigen::Vector2d between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return tangents(from).transpose() * to / from.dot(to);
}

}  // namespace

int mirror_parameters(MirrorKind kind) { return kind == MirrorKind::kHead ? 11 : 14; }

int steered_parameters(MirrorKind kind) {
  return kLensParameters + kPoseParameters + mirror_parameters(kind) + kCurveParameters;
}

std::vector<std::string> steered_parameter_names(MirrorKind kind) {
  std::vector<std::string> names{"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "rx", "ry", "rz", "tx", "ty", "tz"};
  const auto pairs = [&](const std::string& device, std::initializer_list<const char*> what) {
    for (const char* name : what) {
      names.push_back(device + "." + name + "_a");
      names.push_back(device + "." + name + "_b");
    }
  };
  if (kind == MirrorKind::kHead) {
    pairs("outer", {"axis", "point"});
    pairs("inner", {"axis", "point", "normal"});
    names.emplace_back("inner.offset");
  } else {
    for (const char* mirror : {"mirror1", "mirror2"}) {
      pairs(mirror, {"axis", "point", "normal"});
      names.push_back(std::string(mirror) + ".offset");
    }
  }
  for (const char* axis : {"axis1", "axis2"}) {
    for (const char* what : {".gain", ".quadratic", ".cubic", ".cross_talk"}) {
      names.push_back(std::string(axis) + what);
    }
  }
  return names;
}

Eigen::Matrix<double, 3, 2> tangents(const Eigen::Vector3d& unit) {
  Eigen::Index least = 0;
  unit.cwiseAbs().minCoeff(&least);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = Eigen::Vector3d::Unit(least).cross(unit).normalized();
  basis.col(1) = unit.cross(basis.col(0));
  return basis;
}

SteeredProjector perturbed(const SteeredProjector& projector, const Eigen::VectorXd& delta) {
  RAYSTEER_CHECK(delta.size() == steered_parameters(projector.kind));
  SteeredProjector moved = projector;
  moved.lens.fx += delta[0];
  moved.lens.fy += delta[1];
  moved.lens.cx += delta[2];
  moved.lens.cy += delta[3];
  for (int i = 0; i < 4; ++i) {
    moved.lens.k[static_cast<std::size_t>(i)] += delta[4 + i];
  }
  moved.T_projector_rig = moved_by(projector.T_projector_rig, delta.segment<6>(kLensParameters));
  const Eigen::VectorXd by = delta.segment(kLensParameters + kPoseParameters, mirror_parameters(projector.kind));
  visit_mirror(
      moved, [&](Eigen::Vector3d& v, int at) { v = (v + tangents(v) * by.segment<2>(at)).normalized(); },
      [&](Eigen::Vector3d& p, const Eigen::Vector3d& line, int at) { p += tangents(line) * by.segment<2>(at); },
      [&](double& number, int at) { number += by[at]; });
  for (int i = 0; i < 2; ++i) {
    CommandCurve& curve = moved.curves[static_cast<std::size_t>(i)];
    const auto c = delta.tail<kCurveParameters>().segment<4>(4 * i);
    curve.gain += c[0];
    curve.quadratic += c[1];
    curve.cubic += c[2];
    curve.cross_talk += c[3];
  }
  return moved;
}

Eigen::VectorXd departure(const SteeredProjector& from, const SteeredProjector& to) {
  RAYSTEER_CHECK(from.kind == to.kind);
  Eigen::VectorXd delta(steered_parameters(from.kind));
  delta.head<4>() << to.lens.fx - from.lens.fx, to.lens.fy - from.lens.fy, to.lens.cx - from.lens.cx,
      to.lens.cy - from.lens.cy;
  for (int i = 0; i < 4; ++i) {
    delta[4 + i] = to.lens.k[static_cast<std::size_t>(i)] - from.lens.k[static_cast<std::size_t>(i)];
  }
  const Eigen::AngleAxisd turn(to.T_projector_rig.q * from.T_projector_rig.q.conjugate());
  const double angle = turn.angle() > M_PI ? turn.angle() - 2 * M_PI : turn.angle();
  delta.segment<3>(kLensParameters) = angle * turn.axis();
  delta.segment<3>(kLensParameters + 3) = to.T_projector_rig.t - from.T_projector_rig.t;
  auto mirror = delta.segment(kLensParameters + kPoseParameters, mirror_parameters(from.kind));
  // The same visits on both sides: first what `to` holds, in order, then compared as `from` is visited.
  std::vector<Eigen::Vector3d> vectors;
  std::vector<double> numbers;
  visit_mirror(
      to, [&](const Eigen::Vector3d& v, int) { vectors.push_back(v); },
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d&, int) { vectors.push_back(p); },
      [&](const double& number, int) { numbers.push_back(number); });
  std::size_t v_next = 0;
  std::size_t n_next = 0;
  visit_mirror(
      from, [&](const Eigen::Vector3d& v, int at) { mirror.segment<2>(at) = between(v, vectors[v_next++]); },
      [&](const Eigen::Vector3d& p, const Eigen::Vector3d& line, int at) {
        mirror.segment<2>(at) = tangents(line).transpose() * (vectors[v_next++] - p);
      },
      [&](const double& number, int at) { mirror[at] = numbers[n_next++] - number; });
  for (int i = 0; i < 2; ++i) {
    const CommandCurve& a = from.curves[static_cast<std::size_t>(i)];
    const CommandCurve& b = to.curves[static_cast<std::size_t>(i)];
    delta.tail<kCurveParameters>().segment<4>(4 * i) << b.gain - a.gain, b.quadratic - a.quadratic, b.cubic - a.cubic,
        b.cross_talk - a.cross_talk;
  }
  return delta;
}

}  // namespace raysteer::calib::model
