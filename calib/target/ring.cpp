#include "calib/target/ring.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace raysteer::calib::target {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kLeastRadius = 3.0;        // px, of a circle of the disc's area
constexpr double kLeastShortAxis = 1.8;     // px
constexpr double kLeastAxisRatio = 0.35;    // tilt of 69 degrees
constexpr double kLeastContrast = 4;        // grey levels
constexpr double kLeastSignal = 5;          // contrast over noise
constexpr double kLeastMargin = 0.35;       // of the least clear sector
constexpr double kMostRingMisfit = 0.35;    // RMS from black 0 and white 1
constexpr double kOutlineFloor_px = 0.007;  // what is no noise: rounding, the lens's blur
constexpr double kWhiteTo = 0.65;           // radii between which white and black are measured, clear of blur
constexpr double kBlackFrom = 1.38;
constexpr double kBlackTo = 1.68;
constexpr int kSteps = 12;  // samples a sector

Vector2d direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Grey between pixels; outside the image no value.
class Sampler {
 public:
  explicit Sampler(const cv::Mat1f& grey) : grey_(grey) {}
  bool holds(const Vector2d& q, double margin) const {
    return q.x() >= margin && q.y() >= margin && q.x() <= grey_.cols - 1 - margin && q.y() <= grey_.rows - 1 - margin;
  }
  double operator()(const Vector2d& q) const {
    const int x = std::clamp(static_cast<int>(q.x()), 0, grey_.cols - 2);
    const int y = std::clamp(static_cast<int>(q.y()), 0, grey_.rows - 2);
    const double fx = q.x() - x;
    const double fy = q.y() - y;
    const float* a = grey_.ptr<float>(y) + x;
    const float* b = grey_.ptr<float>(y + 1) + x;
    return (1 - fy) * ((1 - fx) * a[0] + fx * a[1]) + fy * ((1 - fx) * b[0] + fx * b[1]);
  }

 private:
  const cv::Mat1f& grey_;
};

/// Grey that changes evenly over the datum: at u in units of the disc's radius it is level + slope * u.
struct Plane {
  double level = 0;
  Vector2d slope = Vector2d::Zero();
  double scatter = 0;  ///< RMS of the samples about it
  double at(const Vector2d& u) const { return level + slope.dot(u); }
};

/// Fits the grey between two radii of the disc.
Plane fit_plane(const Sampler& grey, const Vector2d& q, const Matrix2d& shape, double from, double to) {
  constexpr int kAround = 48;
  constexpr int kAcross = 5;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  double squares = 0;
  for (int i = 0; i < kAcross; ++i) {
    const double s = from + (to - from) * (i + 0.5) / kAcross;
    for (int k = 0; k < kAround; ++k) {
      const Vector2d u = s * direction(kTurn * k / kAround);
      const double value = grey(q + shape * u);
      const Vector3d row(1, u.x(), u.y());
      normal += s * row * row.transpose();
      right += s * value * row;
      squares += s * value * value;
    }
  }
  const Vector3d fit = normal.ldlt().solve(right);
  return {.level = fit(0),
          .slope = fit.tail<2>(),
          .scatter = std::sqrt(std::max(0.0, squares - fit.dot(right)) / normal(0, 0))};
}

/// Grey as a share: 0 where the datum is black, 1 where it is white, free of light that changes evenly.
struct Levels {
  Plane white;
  Plane black;
  double contrast() const { return white.level - black.level; }
  double share(const Vector2d& u, double value) const {
    const double range = std::clamp(white.at(u) - black.at(u), 0.4 * contrast(), 2.5 * contrast());
    return (value - black.at(u)) / range;
  }
};

struct Outline {
  Vector2d q;
  Matrix2d shape;
  Matrix2d cov;
  Levels levels;
};

double short_axis(const Matrix2d& shape) { return shape.jacobiSvd().singularValues()(1); }
double long_axis(const Matrix2d& shape) { return shape.jacobiSvd().singularValues()(0); }

/// One step towards the outline. In units of the disc's radius, the white along direction k ends at
/// 1 + a . u_k + c0 + c1 cos 2t + c2 sin 2t: the middle moves by a, the shape stretches by c. Where white ends is the
/// integral of the grey share across the edge, which blur of any shape leaves alone.
struct Step {
  Eigen::Matrix<double, 5, 1> move;  ///< a, c0, c1, c2
  Matrix2d cov;                      ///< of a
  double misfit = 0;                 ///< RMS, radii
};

std::optional<Step> step_to_outline(const Sampler& grey, const Outline& outline, double reach) {
  const double radius = std::sqrt(std::abs(outline.shape.determinant()));
  const int around = std::clamp(static_cast<int>(8 * radius), 48, 240);
  const int across = std::clamp(static_cast<int>(2 * reach * radius * 3), 12, 60);
  std::vector<double> ends(static_cast<std::size_t>(around));
  Eigen::MatrixXd rows(around, 5);
  for (int k = 0; k < around; ++k) {
    const double t = kTurn * k / around;
    const Vector2d u = direction(t);
    double white = 0;
    for (int i = 0; i < across; ++i) {
      const double s = 1 - reach + 2 * reach * (i + 0.5) / across;
      white += outline.levels.share(s * u, grey(outline.q + outline.shape * (s * u)));
    }
    ends[static_cast<std::size_t>(k)] = reach * (2 * white / across - 1);
    rows.row(k) << u.x(), u.y(), 1, std::cos(2 * t), std::sin(2 * t);
  }
  const Eigen::Map<const Eigen::VectorXd> end(ends.data(), around);
  const Eigen::Matrix<double, 5, 5> normal = rows.transpose() * rows;
  const Eigen::Matrix<double, 5, 5> inverse = normal.inverse();
  Step step;
  step.move = inverse * (rows.transpose() * end);
  const double squares = (end - rows * step.move).squaredNorm() / (around - 5);
  step.misfit = std::sqrt(squares);
  if (!step.move.allFinite()) {
    return std::nullopt;
  }
  // Directions closer than a pixel share their pixels' noise.
  const double shared = std::max(1.0, around / (kTurn * radius));
  step.cov = squares * shared * inverse.topLeftCorner<2, 2>();
  return step;
}

/// Planes that lean by mistake move the middle without leaving a misfit: by reach (1 -+ reach / 2) of the lean over the
/// contrast. The lean's variance is that of a fit to as many pixels as the plane was seen on.
Matrix2d cov_by_levels(const Levels& levels, double radius, double reach) {
  constexpr double kPixelsShared = 2;  // samples between pixels scatter less than the pixels
  const auto lean = [&](const Plane& plane, double from, double to) {
    const double pixels = std::numbers::pi * (to * to - from * from) * radius * radius;
    return kPixelsShared * plane.scatter * plane.scatter / (pixels * (to * to + from * from) / 4);
  };
  const double white = reach * (1 - reach / 2);
  const double black = reach * (1 + reach / 2);
  const double contrast = levels.contrast();
  return (white * white * lean(levels.white, 0, kWhiteTo) + black * black * lean(levels.black, kBlackFrom, kBlackTo)) /
         (contrast * contrast) * Matrix2d::Identity();
}

bool measure_levels(const Sampler& grey, Outline& outline) {
  outline.levels.white = fit_plane(grey, outline.q, outline.shape, 0, kWhiteTo);
  outline.levels.black = fit_plane(grey, outline.q, outline.shape, kBlackFrom, kBlackTo);
  const double contrast = outline.levels.contrast();
  const double noise = std::hypot(outline.levels.white.scatter, outline.levels.black.scatter);
  return contrast >= kLeastContrast && contrast >= kLeastSignal * noise;
}

std::optional<Outline> find_outline(const Sampler& grey, const Vector2d& q, const Matrix2d& shape) {
  constexpr int kIterations = 10;
  constexpr double kStill_px = 1e-3;
  Outline outline{.q = q, .shape = shape, .cov = {}, .levels = {}};
  double misfit = 0;
  for (int i = 0; i < kIterations; ++i) {
    const double radius = std::sqrt(outline.shape.determinant());
    // The whole ring must be in the picture.
    if (!(radius >= kLeastRadius) || !(short_axis(outline.shape) >= kLeastShortAxis) ||
        short_axis(outline.shape) < kLeastAxisRatio * long_axis(outline.shape) ||
        !grey.holds(outline.q, 2.8 * long_axis(outline.shape)) || !measure_levels(grey, outline)) {
      return std::nullopt;
    }
    const double reach = i < 3 ? 0.5 : std::clamp(3.0 / short_axis(outline.shape), 0.2, 0.5);
    const auto step = step_to_outline(grey, outline, reach);
    if (!step || step->move.head<2>().norm() > 0.5 || step->move.tail<3>().norm() > 0.4) {
      return std::nullopt;
    }
    const Matrix2d stretch{{1 + step->move(2) + step->move(3), step->move(4)},
                           {step->move(4), 1 + step->move(2) - step->move(3)}};
    outline.q += outline.shape * step->move.head<2>();
    outline.cov =
        outline.shape * (step->cov + cov_by_levels(outline.levels, radius, reach)) * outline.shape.transpose();
    outline.shape = outline.shape * stretch;
    misfit = step->misfit;
    if (i >= 4 && radius * step->move.norm() < kStill_px) {
      break;
    }
  }
  const double radius = std::sqrt(outline.shape.determinant());
  if (!(misfit < 0.05 + 0.3 / radius) || !outline.cov.allFinite()) {
    return std::nullopt;
  }
  outline.cov += kOutlineFloor_px * kOutlineFloor_px * Matrix2d::Identity();
  return outline;
}

struct Ring {
  unsigned bits = 0;
  double margin = 0;
};

/// Twelve sectors begin at an unknown angle: the one at which sectors are most even within themselves.
std::optional<Ring> read_ring(const Sampler& grey, const Outline& outline) {
  constexpr int kAround = kDatumBits * kSteps;
  std::array<double, kAround> shares{};
  for (int k = 0; k < kAround; ++k) {
    // Seen from its face, +x to +y of a datum is against the clock; in pictures, y down, that is falling angles.
    const Vector2d u = direction(-kTurn * k / kAround);
    for (const double s : {2.3, 2.4, 2.5, 2.6, 2.7}) {
      shares[static_cast<std::size_t>(k)] += outline.levels.share(s * u, grey(outline.q + outline.shape * (s * u))) / 5;
    }
  }
  const auto at = [&](int k) { return shares[static_cast<std::size_t>(k % kAround)]; };
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int begin = 0; begin < kSteps; ++begin) {
    double uneven = 0;
    for (int sector = 0; sector < kDatumBits; ++sector) {
      double sum = 0, squares = 0;
      for (int i = 0; i < kSteps; ++i) {
        const double share = at(begin + sector * kSteps + i);
        sum += share;
        squares += share * share;
      }
      uneven += squares - sum * sum / kSteps;
    }
    if (uneven < least) {
      least = uneven;
      best = begin;
    }
  }
  Ring ring{.bits = 0, .margin = 1};
  double misfit = 0;
  constexpr int kEdge = 3;  // samples at a sector's ends, which blur mixes
  for (int sector = 0; sector < kDatumBits; ++sector) {
    double mean = 0;
    for (int i = kEdge; i < kSteps - kEdge; ++i) {
      mean += at(best + sector * kSteps + i) / (kSteps - 2 * kEdge);
    }
    const bool one = mean > 0.5;
    ring.bits |= one ? 1U << static_cast<unsigned>(sector) : 0U;
    ring.margin = std::min(ring.margin, 2 * std::abs(mean - 0.5));
    misfit += (mean - (one ? 1 : 0)) * (mean - (one ? 1 : 0)) / kDatumBits;
  }
  if (ring.margin < kLeastMargin || std::sqrt(misfit) > kMostRingMisfit) {
    return std::nullopt;
  }
  return ring;
}

}  // namespace

std::optional<SeenDatum> measure_datum(const cv::Mat1f& image, Vector2d q, Matrix2d shape) {
  const Sampler grey(image);
  const auto outline = find_outline(grey, q, shape);
  if (!outline) {
    return std::nullopt;
  }
  const auto ring = read_ring(grey, *outline);
  if (!ring || !std::ranges::binary_search(datum_codes(), smallest_rotation(ring->bits))) {
    return std::nullopt;
  }
  return SeenDatum{.code = smallest_rotation(ring->bits),
                   .q = outline->q,
                   .cov = outline->cov,
                   .shape = outline->shape,
                   .margin = ring->margin,
                   .contrast = outline->levels.contrast()};
}

}  // namespace raysteer::calib::target
