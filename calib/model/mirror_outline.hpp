// value: the mirrors of one look with their outlines: which of the projector's light they pass on, and which misses
// them.
//
// Steering itself (steered_projector.hpp) takes mirrors as endless. Frame: the projector's.
#pragma once

#include <Eigen/Dense>
#include <array>

#include "calib/model/steered_projector.hpp"

namespace raysteer::calib::model {

class MirrorOutlines {
 public:
  MirrorOutlines(const SteeredProjector& projector, const Eigen::Vector2d& angles_rad);

  /// How far inside the outlines panel pixel x's light stays: 1 in the centres, 0 on an edge; negative where it misses
  /// a mirror, meets its back, or (galvo pair) hits the first mirror again on its way out. A mirror drawn without a
  /// size has no edge. -1 where the lens has no ray.
  double slack(const Eigen::Vector2d& x) const;
  bool passes(const Eigen::Vector2d& x) const { return slack(x) >= 0; }
  /// Part of the panel that passes, of columns x rows evenly spread pixels.
  double passing_part(int columns = 9, int rows = 6) const;

 private:
  struct Part {
    Eigen::Vector3d normal;
    Eigen::Vector3d centre;  ///< of the outline, on the surface
    Eigen::Vector3d across;
    Eigen::Vector3d along;
    Eigen::Vector2d half_size_m;
    bool ellipse;

    double slack(const Eigen::Vector3d& p) const;
    void turn(const Eigen::Vector3d& axis, const Eigen::Vector3d& point, double angle);
  };
  static Part at_rest(const MirrorPart& part);

  Camera lens_;
  std::array<Part, 2> parts_;
  int count_;
};

}  // namespace raysteer::calib::model
