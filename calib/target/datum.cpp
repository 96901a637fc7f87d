#include "calib/target/datum.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <variant>

#include "calib/target/ring.hpp"

namespace raysteer::calib::target {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

struct Candidate {
  Vector2d q;
  Matrix2d shape;
};

/// A bright patch that could be a disc, with the ellipse of its moments.
std::optional<Candidate> as_ellipse(const cv::Mat1i& labels, int label, const cv::Rect& box, int area) {
  // The disc stands clear of everything by its black ring: its box's borders are its own.
  double sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0;
  for (int y = box.y; y < box.y + box.height; ++y) {
    const int* row = labels.ptr<int>(y);
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (row[x] == label) {
        const double dx = x - box.x, dy = y - box.y;
        sx += dx;
        sy += dy;
        sxx += dx * dx;
        sxy += dx * dy;
        syy += dy * dy;
      }
    }
  }
  const double n = area;
  const Vector2d mean(sx / n, sy / n);
  // Of the area, pixels being squares: 1/12 px^2 more each way.
  Matrix2d moments{{sxx / n - mean.x() * mean.x() + 1.0 / 12, sxy / n - mean.x() * mean.y()},
                   {sxy / n - mean.x() * mean.y(), syy / n - mean.y() * mean.y() + 1.0 / 12}};
  const double ellipse = 4 * std::numbers::pi * std::sqrt(std::max(0.0, moments.determinant()));
  if (!(ellipse > 0) || n < 0.86 * ellipse || n > 1.08 * ellipse) {
    return std::nullopt;
  }
  return Candidate{.q = mean + Vector2d(box.x, box.y),
                   .shape = 2 * Eigen::SelfAdjointEigenSolver<Matrix2d>(moments).operatorSqrt()};
}

/// Candidates of one level of the pyramid: discs of radius about 3 to 10 px there.
std::vector<Candidate> candidates(const cv::Mat1f& level) {
  constexpr int kWindow = 25;  // holds a disc of radius 10 and half the black around it
  constexpr float kAbove = 2;  // grey levels
  cv::Mat1f smooth, mean;
  cv::GaussianBlur(level, smooth, {3, 3}, 0.7);
  cv::boxFilter(smooth, mean, CV_32F, {kWindow, kWindow}, {-1, -1}, true, cv::BORDER_REPLICATE);
  mean += kAbove;
  cv::Mat bright, labels, stats, centres;
  cv::compare(smooth, mean, bright, cv::CMP_GT);
  const int patches = cv::connectedComponentsWithStats(bright, labels, stats, centres, 4, CV_32S);
  std::vector<Candidate> found;
  for (int patch = 1; patch < patches; ++patch) {
    const int* row = stats.ptr<int>(patch);
    const cv::Rect box(row[cv::CC_STAT_LEFT], row[cv::CC_STAT_TOP], row[cv::CC_STAT_WIDTH], row[cv::CC_STAT_HEIGHT]);
    const int area = row[cv::CC_STAT_AREA];
    if (area < 18 || area > 450 || std::min(box.width, box.height) < 3 || std::max(box.width, box.height) > 34) {
      continue;
    }
    if (const auto candidate = as_ellipse(labels, patch, box, area)) {
      found.push_back(*candidate);
    }
  }
  return found;
}

DatumsInFrame detect(const cv::Mat1f& image) {
  constexpr int kSmallestLevel = 40;  // px; a datum there has less than 3
  std::map<unsigned, std::vector<SeenDatum>> found;
  cv::Mat1f level = image;
  for (double scale = 1; std::min(level.cols, level.rows) >= kSmallestLevel; scale *= 2) {
    for (const Candidate& candidate : candidates(level)) {
      // Pixel centres at integers: halving puts x at (x - 0.5) / 2.
      const Vector2d q = scale * candidate.q + Vector2d::Constant(0.5 * (scale - 1));
      const auto datum = measure_datum(image, q, scale * candidate.shape);
      if (!datum) {
        continue;
      }
      // The same one on two levels of the pyramid.
      auto& seen = found[datum->code];
      const bool known = std::ranges::any_of(
          seen, [&](const SeenDatum& other) { return (other.q - datum->q).norm() < datum->radius_px(); });
      if (!known) {
        seen.push_back(*datum);
      }
    }
    cv::Mat1f half;
    cv::resize(level(cv::Rect(0, 0, level.cols / 2 * 2, level.rows / 2 * 2)), half, {}, 0.5, 0.5, cv::INTER_AREA);
    level = half;
  }
  DatumsInFrame datums;
  for (const auto& [code, seen] : found) {
    if (seen.size() == 1) {
      datums.seen.push_back(seen.front());
    } else {
      datums.doubled.push_back(code);
    }
  }
  return datums;
}

template <class Pixel>
DatumsInFrame detect_in(ImageView<const Pixel> frame) {
  cv::Mat1f image(frame.height(), frame.width());
  for (int y = 0; y < frame.height(); ++y) {
    std::ranges::copy(frame.row_span(y), image.ptr<float>(y));
  }
  return detect(image);
}

}  // namespace

double SeenDatum::radius_px() const { return std::sqrt(std::abs(shape.determinant())); }

DatumsInFrame detect_datums(ImageView<const std::uint8_t> frame) { return detect_in(frame); }
DatumsInFrame detect_datums(ImageView<const std::uint16_t> frame) { return detect_in(frame); }
DatumsInFrame detect_datums(const Frame& frame) {
  return std::visit([](const auto& image) { return detect_in(image.view()); }, frame);
}

// Over the outline, the projection is that of the centre, plus its linear part, plus what bends. An ellipse fitted to
// the outline (in the linear part's own coordinates, where it is nearly a circle) moves by the first harmonic of the
// bend's radial part.
std::optional<Vector2d> ellipse_middle(const model::Camera& camera, const Eigen::Vector3d& centre,
                                       const Eigen::Vector3d& normal, double radius_m) {
  Eigen::Matrix<double, 2, 3> by_point;
  const auto q = camera.project(centre, by_point);
  if (!q) {
    return std::nullopt;
  }
  const Eigen::Vector3d along = normal.unitOrthogonal();
  Eigen::Matrix<double, 3, 2> axes;
  axes << radius_m * along, radius_m * normal.cross(along);
  const Matrix2d linear = by_point * axes;
  const Matrix2d back = linear.inverse();
  if (!back.allFinite()) {
    return q;  // seen from its edge: no ellipse
  }
  constexpr int kAround = 12;
  Vector2d move = Vector2d::Zero();
  for (int k = 0; k < kAround; ++k) {
    const double angle = 2 * std::numbers::pi * k / kAround;
    const Vector2d u(std::cos(angle), std::sin(angle));
    const auto edge = camera.project(centre + axes * u);
    if (!edge) {
      return std::nullopt;
    }
    move += 2.0 / kAround * u * u.dot(back * (*edge - *q) - u);
  }
  return *q + linear * move;
}

}  // namespace raysteer::calib::target
