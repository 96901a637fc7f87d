// value: what each pixel of one camera sees of the room, whatever the projector does: traced once per moment.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "hal/base/image.hpp"
#include "sim/optics/true_rig.hpp"
#include "sim/world/camera_rays.hpp"
#include "sim/world/shapes.hpp"
#include "sim/world/smooth.hpp"

namespace raysteer::sim::world {

/// A piece of one surface that a pixel sees.
struct Sight {
  Eigen::Vector3f p{0, 0, 0};  ///< rig frame: where the ray through the pixel's centre meets it
  std::uint32_t triangle = Tracer::kNothing;
  float reflect = 0;      ///< electrons per second and lux that falls on it, from its matt part
  std::int8_t right = 0;  ///< centre of the reflected light, from the pixel's centre, in 1/254 px
  std::int8_t below = 0;
  bool joins_right = false;  ///< the same smooth surface goes on in the pixel to the right
  bool joins_below = false;
};

/// A pixel that an edge crosses sees several pieces.
struct PartSight {
  Sight sight;
  int x = 0;
  int y = 0;
  float share = 1;  ///< of the pixel
};

class Seen {
 public:
  Seen(const optics::TrueCamera& camera, std::shared_ptr<const Shapes> shapes, int threads);

  const optics::TrueCamera& camera() const { return camera_; }
  const Shapes& shapes() const { return *shapes_; }
  const Eigen::Vector3d& centre() const { return centre_; }
  int width() const { return camera_.width; }
  int height() const { return camera_.height; }

  /// Of pixels that an edge crosses `reflect` is 0; what they see is in parts().
  const Sight* row(int y) const { return sights_.row(y); }
  std::span<const PartSight> parts(int y) const {
    const auto at = static_cast<std::size_t>(y);
    return {parts_.data() + first_part_[at], first_part_[at + 1] - first_part_[at]};
  }
  std::size_t part(int y) const { return first_part_[static_cast<std::size_t>(y)]; }  ///< index of the row's first
  std::size_t parts() const { return parts_.size(); }

  /// Electrons per second and cd/m2.
  double collects(double x, double y) const { return collects_(x, y); }

  /// What a pixel sees of `shapes`, sampled all over: adds its pieces to `parts`.
  void look(const Shapes& shapes, int x, int y, const Eigen::Vector3d& ray, const Eigen::Vector3d& across,
            const Eigen::Vector3d& down, std::vector<PartSight>& parts) const;

 private:
  void trace(int first_row, int end_row);
  void join(int first_row, int end_row);
  void shade(int y, std::vector<PartSight>& parts, std::vector<int>& crossed);

  optics::TrueCamera camera_;
  Eigen::Vector3d centre_;
  CameraRays rays_;
  Smooth collects_;
  std::shared_ptr<const Shapes> shapes_;
  Image<Sight> sights_;
  std::vector<PartSight> parts_;
  std::vector<std::size_t> first_part_;
};

/// What one pixel to the right (or down) moves the point at which `ray` meets a plane: the ray turns, the plane holds
/// it.
inline Eigen::Vector3d slide(const Eigen::Vector3d& from_centre, const Eigen::Vector3d& ray,
                             const Eigen::Vector3d& turn, const Eigen::Vector3d& normal) {
  const double length = from_centre.dot(ray);  // the ray is unit
  return length * (turn - ray * (normal.dot(turn) / normal.dot(ray)));
}

}  // namespace raysteer::sim::world
