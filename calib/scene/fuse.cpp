#include "calib/scene/fuse.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

namespace raysteer::calib::scene {
namespace {

constexpr std::size_t kFewestShared = 50;
constexpr std::size_t kFewestPlaces = 100;
constexpr std::size_t kFewestInFit = 4;  // an affine fit has three numbers
constexpr std::size_t kFewestForScatter = 7;
constexpr double kLeastSpread = 0.02;  // of a fit's points, cells^2: (0.14 cells)^2
constexpr double kMostSigma = 5;       // that two values of one place differ by
constexpr double kGapSigma = 6;        // between two points: two surfaces
constexpr double kGapCells = 1.5;      // and as steep as this
constexpr std::uint32_t kNone = 0xffffffff;

/// A point as the map has it: its place in cells, 1/z and the variance of that.
struct Sample {
  double x, y, w, variance;
};

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

/// Points that lie in one cell of a grid, cell by cell.
class Buckets {
 public:
  Buckets(const std::vector<Sample>& samples, int left, int top, int width, int height)
      : left_(left), top_(top), width_(width), start_(static_cast<std::size_t>(width * height) + 1) {
    for (const Sample& sample : samples) {
      ++start_[at(sample) + 1];
    }
    for (std::size_t k = 1; k < start_.size(); ++k) {
      start_[k] += start_[k - 1];
    }
    std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
    sorted_.resize(samples.size());
    for (const Sample& sample : samples) {
      sorted_[next[at(sample)]++] = sample;
    }
  }
  /// With column and row of the grid's own cells.
  std::span<const Sample> operator()(int column, int row) const {
    const auto k = static_cast<std::size_t>(row * width_ + column);
    return std::span(sorted_).subspan(start_[k], start_[k + 1] - start_[k]);
  }

 private:
  std::size_t at(const Sample& sample) const {
    return static_cast<std::size_t>((static_cast<int>(std::floor(sample.y)) - top_) * width_ +
                                    static_cast<int>(std::floor(sample.x)) - left_);
  }
  int left_, top_, width_;
  std::vector<std::size_t> start_;
  std::vector<Sample> sorted_;
};

double tent(const Sample& sample, int x, int y) { return (1 - std::abs(sample.x - x)) * (1 - std::abs(sample.y - y)); }

/// Of samples around a node those of one surface: between two surfaces depths leave a gap.
std::span<const Sample> one_surface(std::vector<Sample>& near, int x, int y, double cell) {
  std::ranges::sort(near, {}, &Sample::w);
  std::size_t first = 0;
  std::size_t best_first = 0;
  std::size_t best_end = 0;
  double weight = 0;
  double best = -1;
  for (std::size_t k = 0; k < near.size(); ++k) {
    weight += tent(near[k], x, y);
    const bool last = k + 1 == near.size();
    const double gap = last ? 0 : near[k + 1].w - near[k].w;
    const double wide = last ? 0
                             : std::max(kGapSigma * std::sqrt(near[k].variance + near[k + 1].variance),
                                        kGapCells * cell * near[k].w);  // dz = z cell is dw = w cell
    if (last || gap > wide) {
      if (weight > best) {
        best = weight;
        best_first = first;
        best_end = k + 1;
      }
      first = k + 1;
      weight = 0;
    }
  }
  return std::span(near).subspan(best_first, best_end - best_first);
}

struct Fitted {
  double w, variance;
};

/// The value at the node of a plane through the samples. Nothing where they lie to one side, so that it would be
/// guessed.
std::optional<Fitted> fit(std::span<const Sample> samples, int x, int y) {
  if (samples.size() < kFewestInFit) {
    return std::nullopt;
  }
  // About the samples' own middle, which the plane is best known at.
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double mean = 0;
  double sum = 0;
  double least = std::numeric_limits<double>::infinity();
  for (const Sample& sample : samples) {
    const double weight = tent(sample, x, y) / sample.variance;
    middle += weight * Eigen::Vector2d(sample.x - x, sample.y - y);
    mean += weight * sample.w;
    sum += weight;
    least = std::min(least, sample.variance);
  }
  middle /= sum;
  mean /= sum;
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d rise = Eigen::Vector2d::Zero();
  for (const Sample& sample : samples) {
    const double weight = tent(sample, x, y) / (sample.variance * sum);
    const Eigen::Vector2d d = Eigen::Vector2d(sample.x - x, sample.y - y) - middle;
    spread += weight * d * d.transpose();
    rise += weight * d * (sample.w - mean);
  }
  if (!(spread.determinant() > kLeastSpread * kLeastSpread)) {
    return std::nullopt;  // all about in a line
  }
  const Eigen::Matrix2d inverse = spread.inverse();
  const Eigen::Vector2d slope = inverse * rise;
  const double value = mean - slope.dot(middle);
  if (!std::isfinite(value) || !(value > 0)) {
    return std::nullopt;
  }
  // Of the value, with each sample's own noise; and the scatter about the plane where that is more.
  const Eigen::Vector2d reach = inverse * middle;
  double variance = 0;
  double chi_square = 0;
  double weights = 0;
  for (const Sample& sample : samples) {
    const double weight = tent(sample, x, y);
    const Eigen::Vector2d at(sample.x - x, sample.y - y);
    variance += std::pow(weight / (sample.variance * sum) * (1 - reach.dot(at - middle)), 2) * sample.variance;
    chi_square += weight * std::pow(value + slope.dot(at) - sample.w, 2) / sample.variance;
    weights += weight;
  }
  if (!(variance > 0) || variance > least) {
    return std::nullopt;  // worse than one point: guessed from beside
  }
  const auto n = static_cast<double>(samples.size());
  const double scatter = samples.size() < kFewestForScatter ? 1 : chi_square / weights * n / (n - 3);
  return Fitted{value, variance * std::max(1.0, scatter)};
}

}  // namespace

Result<double> cell_for(std::span<const CloudPoint> points, std::span<const Match> matches) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < points.size(); ++k) {
    const Match& a = matches[points[k - 1].match];
    const Match& b = matches[points[k].match];
    if (a.j == b.j && a.i + 1 == b.i) {
      steps.push_back((points[k].p.hnormalized() - points[k - 1].p.hnormalized()).norm());
    }
  }
  if (steps.empty()) {
    return fail(RCode::kTooFewMatches, "no two neighbours on the panel were matched");
  }
  // Finer than that no camera sees, and a map of the whole field would not fit into memory.
  constexpr double kFinest = 5e-4;
  return std::max(kFinest, 2 * quantile(steps, 0.5));
}

void Fusion::add(std::string name, std::span<const CloudPoint> points) {
  Map map;
  map.look.name = std::move(name);
  map.look.points = points.size();
  std::vector<Sample> samples;
  samples.reserve(points.size());
  Eigen::Vector2i least = Eigen::Vector2i::Constant(std::numeric_limits<int>::max());
  Eigen::Vector2i most = Eigen::Vector2i::Constant(std::numeric_limits<int>::min());
  constexpr double kFarthest = 2;  // X/Z: 63 degrees off the axis
  for (const CloudPoint& point : points) {
    const Eigen::Vector2d n = point.p.hnormalized();
    const double z = point.p.z();
    const double variance = point.covariance(2, 2) / (z * z * z * z);
    if (!(z > 0) || !(n.cwiseAbs().maxCoeff() < kFarthest) || !(variance > 0) || !std::isfinite(variance)) {
      continue;
    }
    samples.push_back({n.x() / cell_, n.y() / cell_, 1 / z, variance});
    const Eigen::Vector2i at(static_cast<int>(std::floor(samples.back().x)),
                             static_cast<int>(std::floor(samples.back().y)));
    least = least.cwiseMin(at);
    most = most.cwiseMax(at);
  }
  if (!samples.empty()) {
    // A border of cells without samples, so that every node has four.
    const Eigen::Vector2i size = most - least + Eigen::Vector2i::Constant(3);
    const Buckets buckets(samples, least.x() - 1, least.y() - 1, size.x(), size.y());
    map.left = least.x();
    map.top = least.y();
    map.nodes = Image<Node>(size.x() - 1, size.y() - 1);
    std::vector<Sample> near;
    for (int row = 0; row + 1 < size.y(); ++row) {
      for (int column = 0; column + 1 < size.x(); ++column) {
        near.clear();
        for (const auto& [c, r] :
             {std::pair(column, row), {column + 1, row}, {column, row + 1}, {column + 1, row + 1}}) {
          const auto bucket = buckets(c, r);
          near.insert(near.end(), bucket.begin(), bucket.end());
        }
        const int x = map.left + column;
        const int y = map.top + row;
        if (const auto value = fit(one_surface(near, x, y, cell_), x, y)) {
          map.nodes(column, row) = {static_cast<float>(value->w), static_cast<float>(std::sqrt(value->variance))};
          ++map.look.places;
        }
      }
    }
  }
  maps_.push_back(std::move(map));
}

bool Fusion::agree(const Node& a, const Node& b) const {
  const double z = 2 / (double{a.w} + b.w);
  const double off = std::abs(double{a.w} - b.w);
  return off * z * z <= options_.apart_m || off <= kMostSigma * std::hypot(a.sigma, b.sigma);
}

Overlap Fusion::compare(std::size_t first, std::size_t second, std::vector<double>& all_m) const {
  const Map& a = maps_[first];
  const Map& b = maps_[second];
  Overlap overlap{.first = first, .second = second};
  std::vector<double> signed_m;
  std::vector<double> whitened;
  std::size_t apart = 0;
  for (int y = std::max(a.top, b.top); y < std::min(a.top + a.nodes.height(), b.top + b.nodes.height()); ++y) {
    for (int x = std::max(a.left, b.left); x < std::min(a.left + a.nodes.width(), b.left + b.nodes.width()); ++x) {
      const Node* in_a = a.at(x, y);
      const Node* in_b = b.at(x, y);
      if (in_a == nullptr || in_b == nullptr) {
        continue;
      }
      signed_m.push_back((1 / double{in_b->w} - 1 / double{in_a->w}) * direction(x, y).homogeneous().norm());
      whitened.push_back(std::abs(double{in_b->w} - in_a->w) / std::hypot(in_a->sigma, in_b->sigma));
      apart += agree(*in_a, *in_b) ? 0 : 1;
    }
  }
  overlap.shared = signed_m.size();
  if (overlap.shared < kFewestShared) {
    return overlap;
  }
  std::vector<double> distance(signed_m.size());
  std::ranges::transform(signed_m, distance.begin(), [](double d) { return std::abs(d); });
  all_m.insert(all_m.end(), distance.begin(), distance.end());
  overlap.apart = static_cast<double>(apart) / static_cast<double>(overlap.shared);
  overlap.median_mm = 1e3 * quantile(distance, 0.5);
  overlap.p95_mm = 1e3 * quantile(distance, 0.95);
  overlap.bias_mm = 1e3 * quantile(signed_m, 0.5);
  overlap.whitened = 1.4826 * quantile(whitened, 0.5);
  return overlap;
}

/// What most looks say of a place: those that agree with the median, which must be more than half.
Fusion::Node Fusion::joined(int x, int y, std::vector<const Node*>& at, FusedSurface& surface) const {
  at.clear();
  for (const Map& map : maps_) {
    if (const Node* node = map.at(x, y)) {
      at.push_back(node);
    }
  }
  if (at.empty()) {
    return {};
  }
  std::ranges::sort(at, {}, [](const Node* node) { return node->w; });
  const Node& median = *at[at.size() / 2];
  double information = 0;
  double sum = 0;
  std::size_t kept = 0;
  for (const Node* node : at) {
    if (agree(*node, median)) {
      const double weight = 1 / (double{node->sigma} * node->sigma);
      information += weight;
      sum += weight * node->w;
      ++kept;
    }
  }
  if (2 * kept <= at.size()) {
    ++surface.contested;
    return {};
  }
  const Node value{static_cast<float>(sum / information), static_cast<float>(1 / std::sqrt(information))};
  for (std::size_t k = 0; kept < at.size() && k < maps_.size(); ++k) {
    const Node* node = maps_[k].at(x, y);
    surface.looks[k].dropped += node != nullptr && !agree(*node, median) ? 1 : 0;
  }
  return value;
}

void Fusion::mesh(const Image<std::uint32_t>& index, FusedSurface& surface) const {
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == kNone || b == kNone || c == kNone) {
      return;
    }
    const Eigen::Vector3d& p = surface.points[a];
    const Eigen::Vector3d normal = (surface.points[b] - p).cross(surface.points[c] - p);
    if (std::abs(normal.dot(p)) > std::cos(options_.flattest_rad) * normal.norm() * p.norm()) {
      surface.triangles.push_back({a, b, c});
    }
  };
  for (int y = 0; y + 1 < index.height(); ++y) {
    for (int x = 0; x + 1 < index.width(); ++x) {
      // x right, y down, seen from before: against the clock is down first.
      add(index(x, y), index(x, y + 1), index(x + 1, y));
      add(index(x + 1, y), index(x, y + 1), index(x + 1, y + 1));
    }
  }
}

Result<FusedSurface> Fusion::fuse() const {
  FusedSurface surface;
  surface.cell = cell_;
  std::vector<double> all_m;
  std::vector<double> whitened;
  std::vector<int> against(maps_.size());
  const Overlap* worst = nullptr;
  int left = std::numeric_limits<int>::max(), top = left, right = std::numeric_limits<int>::min(), bottom = right;
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    const Map& map = maps_[k];
    surface.looks.push_back(map.look);
    if (!map.nodes.empty()) {
      left = std::min(left, map.left);
      top = std::min(top, map.top);
      right = std::max(right, map.left + map.nodes.width());
      bottom = std::max(bottom, map.top + map.nodes.height());
    }
    for (std::size_t other = 0; other < k; ++other) {
      const Overlap overlap = compare(other, k, all_m);
      if (overlap.shared >= kFewestShared) {
        surface.overlaps.push_back(overlap);
        whitened.push_back(overlap.whitened);
      }
    }
  }
  for (const Overlap& overlap : surface.overlaps) {
    if (overlap.apart > options_.most_apart) {
      ++against[overlap.first];
      ++against[overlap.second];
      worst = worst == nullptr || overlap.apart > worst->apart ? &overlap : worst;
    }
  }
  if (worst != nullptr) {
    const auto look = static_cast<std::size_t>(std::ranges::max_element(against) - against.begin());
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), "%.1f mm (median) at %zu common places, %.0f %% of which disagree",
                  worst->median_mm, worst->shared, 100 * worst->apart);
    return fail(RCode::kSurfacesApart, "looks '" + maps_[worst->first].look.name + "' and '" +
                                           maps_[worst->second].look.name + "' are apart by " + text.data() +
                                           "; look '" + maps_[look].look.name + "' disagrees with " +
                                           std::to_string(against[look]) + " others");
  }
  surface.shared = all_m.size();
  if (!all_m.empty()) {
    surface.median_mm = 1e3 * quantile(all_m, 0.5);
    surface.p95_mm = 1e3 * quantile(all_m, 0.95);
  }
  // Neighbouring points share camera pixels, and decoding errs alike there: looks that differ by more than stated say
  // by how much.
  const double honest = whitened.empty() ? 1 : std::max(1.0, quantile(whitened, 0.5));
  if (right < left) {
    return fail(RCode::kTooFewMatches, "no look has a point that can be fused");
  }
  Image<std::uint32_t> index(right - left, bottom - top);
  std::vector<const Node*> at;
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      const Node node = joined(x, y, at, surface);
      index(x - left, y - top) = node.w > 0 ? static_cast<std::uint32_t>(surface.points.size()) : kNone;
      if (node.w > 0) {
        const Eigen::Vector3d ray = direction(x, y).homogeneous();
        surface.points.push_back(ray / double{node.w});
        surface.sigma_m.push_back(
            static_cast<float>(honest * ray.norm() * double{node.sigma} / (double{node.w} * node.w)));
      }
    }
  }
  if (surface.points.size() < kFewestPlaces) {
    return fail(RCode::kTooFewMatches, std::to_string(surface.points.size()) + " places of the surface are known, " +
                                           std::to_string(kFewestPlaces) + " are needed");
  }
  mesh(index, surface);
  return surface;
}

}  // namespace raysteer::calib::scene
