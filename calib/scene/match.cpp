#include "calib/scene/match.hpp"

#include <algorithm>
#include <cmath>

namespace raysteer::calib::scene {
namespace {

/// Camera pixels of one surface stay this close to their node's centroid: four camera pixels a projector pixel is the
/// coarsest pitch at which neighbours still touch.
constexpr int kReachPx = 4;

/// Sums of the pixels whose own coordinate rounds to one node.
struct Own {
  float u = 0, v = 0;
  std::uint16_t pixels = 0;
};

/// Nodes: one camera pixel sees at most this many projector pixels when every projector pixel is one ...
constexpr double kFinePitch = 1.3;
/// ... and where it sees more, they are this many camera pixels apart.
constexpr double kPixelsANode = 1.5;

bool measured(const decode::CodeMap& map, int u, int v) {
  return map.mask(u, v) == decode::kValid && std::isfinite(map.x(u, v)) && std::isfinite(map.y(u, v));
}

/// Projector px that one camera pixel covers, along a side: root of the area, median over the view.
double pitch_of(const decode::CodeMap& map) {
  if (map.x.empty() || map.y.empty()) {
    return 1;
  }
  std::vector<double> sides;
  for (int v = 0; v + 1 < map.x.height(); v += 3) {
    for (int u = 0; u + 1 < map.x.width(); u += 3) {
      if (measured(map, u, v) && measured(map, u + 1, v) && measured(map, u, v + 1)) {
        const float area = (map.x(u + 1, v) - map.x(u, v)) * (map.y(u, v + 1) - map.y(u, v)) -
                           (map.x(u, v + 1) - map.x(u, v)) * (map.y(u + 1, v) - map.y(u, v));
        sides.push_back(std::sqrt(std::abs(static_cast<double>(area))));
      }
    }
  }
  if (sides.empty()) {
    return 1;
  }
  const auto middle = sides.begin() + static_cast<std::ptrdiff_t>(sides.size() / 2);
  std::ranges::nth_element(sides, middle);
  return *middle;
}

/// Integer centroids, which say where to look.
Image<Own> own_pixels(const decode::CodeMap& map, int columns, int rows, float spacing) {
  Image<Own> own(columns, rows);
  for (int v = 0; v < map.x.height(); ++v) {
    for (int u = 0; u < map.x.width(); ++u) {
      if (!measured(map, u, v)) {
        continue;
      }
      const long i = std::lround(map.x(u, v) / spacing);
      const long j = std::lround(map.y(u, v) / spacing);
      if (i < 0 || j < 0 || i >= columns || j >= rows) {
        continue;
      }
      Own& o = own(static_cast<int>(i), static_cast<int>(j));
      o.u += static_cast<float>(u);
      o.v += static_cast<float>(v);
      ++o.pixels;
    }
  }
  return own;
}

/// Where to look for (i, j): its own centroid, or the middle of two opposite neighbours that have one.
bool start(const Image<Own>& own, int i, int j, float& u, float& v) {
  const auto centroid = [&](int a, int b, float& cu, float& cv) {
    if (!own.view().contains(a, b) || own(a, b).pixels == 0) {
      return false;
    }
    const Own& o = own(a, b);
    cu = o.u / static_cast<float>(o.pixels);
    cv = o.v / static_cast<float>(o.pixels);
    return true;
  };
  if (centroid(i, j, u, v)) {
    return true;
  }
  float u0 = 0, v0 = 0, u1 = 0, v1 = 0;
  const bool between = (centroid(i - 1, j, u0, v0) && centroid(i + 1, j, u1, v1)) ||
                       (centroid(i, j - 1, u0, v0) && centroid(i, j + 1, u1, v1));
  u = (u0 + u1) / 2;
  v = (v0 + v1) / 2;
  return between && std::abs(u1 - u0) <= kReachPx && std::abs(v1 - v0) <= kReachPx;
}

/// Added to a coordinate's variance before it becomes a weight, px^2: no pixel is trusted beyond 0.05 px, so that a few
/// lucky ones do not outweigh their surroundings.
constexpr float kVarianceFloor = 0.05F * 0.05F;

/// Weighted sums of an affine model q = q0 + A (x / spacing - i, y / spacing - j).
struct AffineFit {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  double variance_x = 0, variance_y = 0;  ///< sums of weight^2 x the decoder's variances
  int count = 0;
};

AffineFit gather(const decode::CodeMap& map, int i, int j, float spacing, float u0, float v0) {
  AffineFit fit;
  const float scale = 1 / spacing;
  const float floor = kVarianceFloor * scale * scale;
  const int uc = static_cast<int>(std::lround(u0));
  const int vc = static_cast<int>(std::lround(v0));
  const int u_from = std::max(uc - kReachPx, 0), u_to = std::min(uc + kReachPx, map.x.width() - 1);
  const int v_from = std::max(vc - kReachPx, 0), v_to = std::min(vc + kReachPx, map.x.height() - 1);
  for (int v = v_from; v <= v_to; ++v) {
    const float* xs = map.x.row(v);
    const float* ys = map.y.row(v);
    for (int u = u_from; u <= u_to; ++u) {
      const float dx = scale * xs[u] - static_cast<float>(i);
      const float dy = scale * ys[u] - static_cast<float>(j);
      if (!(std::abs(dx) < 1 && std::abs(dy) < 1) || map.mask(u, v) != decode::kValid) {
        continue;
      }
      const float vx = scale * scale * map.variance_x(u, v);
      const float vy = scale * scale * map.variance_y(u, v);
      const auto weight = static_cast<double>((1 - std::abs(dx)) * (1 - std::abs(dy)) * floor / (vx + vy + floor));
      const Eigen::Vector3d row(1, static_cast<double>(dx), static_cast<double>(dy));
      const Eigen::RowVector2d q(u - static_cast<double>(u0), v - static_cast<double>(v0));
      fit.normal.noalias() += weight * row * row.transpose();
      fit.right.noalias() += weight * row * q;
      fit.variance_x += weight * weight * static_cast<double>(vx);
      fit.variance_y += weight * weight * static_cast<double>(vy);
      ++fit.count;
    }
  }
  return fit;
}

Sighting sight(const decode::CodeMap& map, const Image<Own>& own, int i, int j, float spacing) {
  Sighting sighting;
  float u0 = 0, v0 = 0;
  if (!start(own, i, j, u0, v0)) {
    return sighting;
  }
  const AffineFit fit = gather(map, i, j, spacing, u0, v0);
  if (fit.count < 3) {
    return sighting;
  }
  // Too few pixels around it, or all in a line: no slope, so no place between them.
  const Eigen::LDLT<Eigen::Matrix3d> ldlt(fit.normal);
  if (!(ldlt.vectorD().minCoeff() > 1e-3 * ldlt.vectorD().maxCoeff())) {
    return sighting;
  }
  const Eigen::Matrix<double, 3, 2> solution = ldlt.solve(fit.right);
  const Eigen::Vector2d q0 = solution.row(0).transpose();
  const Eigen::Matrix2d slope = solution.bottomRows<2>().transpose();
  const double total = fit.normal(0, 0);
  const Eigen::Vector2d variance = Eigen::Vector2d(fit.variance_x, fit.variance_y) / (total * total);
  const Eigen::Matrix2d covariance = slope * variance.asDiagonal() * slope.transpose();
  if (q0.cwiseAbs().maxCoeff() > kReachPx || !covariance.allFinite()) {
    return sighting;
  }
  sighting.q = Eigen::Vector2f(u0, v0) + q0.cast<float>();
  sighting.cxx = static_cast<float>(covariance(0, 0));
  sighting.cxy = static_cast<float>(covariance(0, 1));
  sighting.cyy = static_cast<float>(covariance(1, 1));
  sighting.pixels = own(i, j).pixels;
  sighting.support = static_cast<std::uint16_t>(fit.count);
  return sighting;
}

Eigen::Matrix2d covariance(const Sighting& s) {
  Eigen::Matrix2d c;
  c << static_cast<double>(s.cxx), static_cast<double>(s.cxy), static_cast<double>(s.cxy), static_cast<double>(s.cyy);
  return c;
}

}  // namespace

int node_spacing(const decode::CodeMap& left, const decode::CodeMap& right) {
  const double pitch = std::max(pitch_of(left), pitch_of(right));
  return pitch <= kFinePitch ? 1 : static_cast<int>(std::lround(kPixelsANode * pitch));
}

Result<Image<Sighting>> locate(const decode::CodeMap& map, int panel_width, int panel_height, int spacing) {
  if (map.x.empty() || map.y.empty()) {
    return fail(RCode::kNothingDecoded,
                "scanning needs columns and rows of the projector; the sequence codes only one");
  }
  const int columns = (panel_width - 1) / spacing + 1;
  const int rows = (panel_height - 1) / spacing + 1;
  const Image<Own> own = own_pixels(map, columns, rows, static_cast<float>(spacing));
  Image<Sighting> sightings(columns, rows);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      sightings(i, j) = sight(map, own, i, j, static_cast<float>(spacing));
    }
  }
  return sightings;
}

Matches match(const Image<Sighting>& left, const Image<Sighting>& right) {
  RAYSTEER_CHECK(left.width() == right.width() && left.height() == right.height());
  Matches matches;
  for (int j = 0; j < left.height(); ++j) {
    for (int i = 0; i < left.width(); ++i) {
      const Sighting& a = left(i, j);
      const Sighting& b = right(i, j);
      if (!a.seen() || !b.seen()) {
        continue;
      }
      if (a.interpolated() || b.interpolated()) {
        ++matches.interpolated;
        continue;
      }
      matches.measured.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), a.q.cast<double>(),
                                  b.q.cast<double>(), covariance(a), covariance(b)});
    }
  }
  return matches;
}

Matches match_projector(const Image<Sighting>& camera, int spacing) {
  Matches matches;
  for (int j = 0; j < camera.height(); ++j) {
    for (int i = 0; i < camera.width(); ++i) {
      const Sighting& a = camera(i, j);
      if (!a.seen()) {
        continue;
      }
      if (a.interpolated()) {
        ++matches.interpolated;
        continue;
      }
      matches.measured.push_back({static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(j), a.q.cast<double>(),
                                  Eigen::Vector2d(i * spacing, j * spacing), covariance(a), Eigen::Matrix2d::Zero()});
    }
  }
  return matches;
}

}  // namespace raysteer::calib::scene
