#include "calib/bake/panel_rays.hpp"

#include <limits>

#include "calib/bake/in_parallel.hpp"

namespace raysteer::calib::bake {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

PanelRay panel_ray(const model::Camera& lens, const Eigen::Vector2d& x) {
  const auto n = lens.normalize(x);
  if (!n) {
    return {.m = Eigen::Vector3d::Constant(kNone), .magnify = kNone};
  }
  Eigen::Matrix2d by_n;
  lens.distort(*n, by_n);
  return {.m = n->homogeneous(), .magnify = by_n.determinant()};
}

PanelRays::PanelRays(const model::Camera& lens, int threads)
    : lens_(lens), rays_(static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height)) {
  in_parallel(lens.height, threads, [&](int y) { fill_row(y); });
}

void PanelRays::fill_row(int y) {
  Stored* row = rays_.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(lens_.width);
  Eigen::Vector2d last(kNone, kNone);
  Eigen::Vector2d before = last;
  for (int x = 0; x < lens_.width; ++x) {
    const Eigen::Vector2d d((x - lens_.cx) / lens_.fx, (y - lens_.cy) / lens_.fy);
    // The two pixels before tell where this one's ray is to 1e-8; one step of Newton from there is exact.
    Eigen::Vector2d n = 2 * last - before;
    Eigen::Matrix2d by_n;
    bool found = false;
    for (int step = 0; step < 4 && !found && x >= 2; ++step) {
      const Eigen::Vector2d miss = lens_.distort(n, by_n) - d;
      found = miss.squaredNorm() < 1e-28;  // NaN: not found
      if (!found) {
        n -= by_n.inverse() * miss;
      }
    }
    double magnify = by_n.determinant();
    if (!found || !(magnify > 0)) {
      const PanelRay ray = panel_ray(lens_, {x, y});
      n = ray.m.head<2>();
      magnify = ray.magnify;
    }
    row[x] = {n.x(), n.y(), magnify};
    before = last;
    last = n;
  }
}

}  // namespace raysteer::calib::bake
