#include "calib/solve/correspondences.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace raysteer::calib::solve {
namespace {

constexpr double kBorder = 2;        // px: nearer to a black-white border, the camera mixes both (algorithms 3.2)
constexpr double kReach = 0.6;       // of a square: how far around a corner the quadratic is fitted
constexpr int kPixelsPerView = 600;  // more do not help: what the model misses is the same for neighbours
constexpr double kModelSigma = 0.1;  // px: added to the decoded sigma, which is too small where noise repeats

struct Pixel {
  Eigen::Vector2d q;
  Eigen::Vector2d x;
  double variance = 0;
};

// Corners of the target by column and row, with one more line all around (extrapolated), so that the outer squares,
// which no detected corner closes, have borders too.
class Lattice {
 public:
  Lattice(const TargetSpec& target, std::span<const target::Corner> corners)
      : columns_(target.corner_columns() + 2), rows_(target.corner_rows() + 2) {
    places_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (const target::Corner& corner : corners) {
      at(corner.id % target.corner_columns() + 1, corner.id / target.corner_columns() + 1) = corner.q;
    }
    for (int row = 1; row < rows_ - 1; ++row) {
      extend(0, row, 1, 0);
      extend(columns_ - 1, row, -1, 0);
    }
    for (int column = 0; column < columns_; ++column) {
      extend(column, 0, 0, 1);
      extend(column, rows_ - 1, 0, -1);
    }
  }
  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::optional<Eigen::Vector2d>& at(int column, int row) {
    return places_[static_cast<std::size_t>(row * columns_ + column)];
  }
  const std::optional<Eigen::Vector2d>& at(int column, int row) const {
    return places_[static_cast<std::size_t>(row * columns_ + column)];
  }

 private:
  void extend(int column, int row, int dx, int dy) {
    const auto& near = at(column + dx, row + dy);
    const auto& next = at(column + 2 * dx, row + 2 * dy);
    if (near && next) {
      at(column, row) = 2 * *near - *next;
    }
  }
  int columns_, rows_;
  std::vector<std::optional<Eigen::Vector2d>> places_;
};

// Decoded pixels inside the square right of and below lattice place (column, row), away from its borders.
std::vector<Pixel> pixels_of_square(const decode::CodeMap& map, const Lattice& lattice, int column, int row) {
  const std::array square{lattice.at(column, row), lattice.at(column + 1, row), lattice.at(column + 1, row + 1),
                          lattice.at(column, row + 1)};
  if (!std::ranges::all_of(square, [](const auto& corner) { return corner.has_value(); })) {
    return {};
  }
  Eigen::Vector2d low = *square[0];
  Eigen::Vector2d high = *square[0];
  for (const auto& corner : square) {
    low = low.cwiseMin(*corner);
    high = high.cwiseMax(*corner);
  }
  const int left = std::max(0, static_cast<int>(std::ceil(low.x())));
  const int right = std::min(map.mask.width() - 1, static_cast<int>(std::floor(high.x())));
  const int top = std::max(0, static_cast<int>(std::ceil(low.y())));
  const int bottom = std::min(map.mask.height() - 1, static_cast<int>(std::floor(high.y())));
  std::vector<Pixel> pixels;
  for (int y = top; y <= bottom; ++y) {
    for (int x = left; x <= right; ++x) {
      if (map.mask(x, y) != decode::kValid) {
        continue;
      }
      const Eigen::Vector2d q(x, y);
      bool inside = true;
      for (std::size_t i = 0; i < 4 && inside; ++i) {
        const Eigen::Vector2d along = *square[(i + 1) % 4] - *square[i];
        const Eigen::Vector2d to = q - *square[i];
        inside = along.x() * to.y() - along.y() * to.x() >= kBorder * along.norm();
      }
      const Eigen::Vector2d panel(map.x(x, y), map.y(x, y));
      const double variance = (map.variance_x(x, y) + map.variance_y(x, y)) / 2;
      if (inside && panel.allFinite() && std::isfinite(variance)) {
        pixels.push_back({q, panel, variance});
      }
    }
  }
  return pixels;
}

// Does the square with this column and row (of squares, from the top left) show one plain grey? Markers do not.
bool is_plain(const TargetSpec& target, int column, int row) {
  if (target.kind == TargetKind::kChessboard) {
    return true;
  }
  const bool first_carries = target.layout == CharucoLayout::kLegacy && target.rows % 2 == 0;
  return ((column + row) % 2 == 0) != first_carries;
}

// Value at `corner` of the quadratic through the pixels near it; robust by three rounds of Huber weights.
std::optional<target::Corner> panel_corner(int id, const Eigen::Vector2d& corner, double reach,
                                           const std::vector<const std::vector<Pixel>*>& squares) {
  std::vector<const Pixel*> near;
  int sides = 0;
  for (const auto* square : squares) {
    const std::size_t before = near.size();
    for (const Pixel& pixel : *square) {
      if ((pixel.q - corner).squaredNorm() <= reach * reach) {
        near.push_back(&pixel);
      }
    }
    sides += near.size() >= before + 5 ? 1 : 0;
  }
  if (sides < 2 || near.size() < 30) {
    return std::nullopt;
  }
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  Eigen::Matrix<double, 6, 2> coefficients = Eigen::Matrix<double, 6, 2>::Zero();
  Matrix6 normal;
  double squares_sum = 0;
  double weights_sum = 0;
  for (int round = 0; round < 4; ++round) {
    normal.setZero();
    Eigen::Matrix<double, 6, 2> right = Eigen::Matrix<double, 6, 2>::Zero();
    squares_sum = 0;
    weights_sum = 0;
    for (const Pixel* pixel : near) {
      const Eigen::Vector2d d = (pixel->q - corner) / reach;
      Eigen::Matrix<double, 6, 1> row;
      row << 1, d.x(), d.y(), d.x() * d.x(), d.x() * d.y(), d.y() * d.y();
      const double variance = pixel->variance + kModelSigma * kModelSigma;
      double weight = 1 / variance;
      if (round > 0) {
        const double miss = (pixel->x - coefficients.transpose() * row).norm() / std::sqrt(variance);
        weight *= miss > 2 ? 2 / miss : 1;
        squares_sum += weight * variance * miss * miss;
      }
      weights_sum += weight * variance;
      normal += weight * row * row.transpose();
      right += weight * row * pixel->x.transpose();
    }
    const Eigen::LDLT<Matrix6> ldlt(normal);
    if (ldlt.info() != Eigen::Success || ldlt.rcond() < 1e-9) {
      return std::nullopt;
    }
    coefficients = ldlt.solve(right);
  }
  const double factor = squares_sum / (2 * weights_sum);  // 1 when the variances are right
  const Matrix6 covariance = normal.inverse() * std::max(1.0, factor);
  return target::Corner{id, coefficients.row(0).transpose(), std::sqrt(covariance(0, 0))};
}

}  // namespace

Result<Correspondences> correspondences(const decode::CodeMap& map, const TargetSpec& target,
                                        std::span<const target::Corner> corners, int camera) {
  if (map.x.empty() || map.y.empty()) {
    return fail(RCode::kTooFewCorrespondences, "the sequence codes one axis only; a projector needs both");
  }
  const Lattice lattice(target, corners);
  const int squares_across = lattice.columns() - 1;
  std::vector<std::vector<Pixel>> squares;
  for (int row = 0; row + 1 < lattice.rows(); ++row) {
    for (int column = 0; column + 1 < lattice.columns(); ++column) {
      squares.push_back(is_plain(target, column, row) ? pixels_of_square(map, lattice, column, row)
                                                      : std::vector<Pixel>{});
    }
  }
  const auto square = [&](int column, int row) -> const std::vector<Pixel>& {
    return squares[static_cast<std::size_t>(row * squares_across + column)];
  };

  Correspondences result;
  for (const target::Corner& corner : corners) {
    const int column = corner.id % target.corner_columns() + 1;
    const int row = corner.id / target.corner_columns() + 1;
    double side = 0;
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (const auto& neighbour = lattice.at(column + dx, row + dy)) {
        side = std::max(side, (*neighbour - corner.q).norm());
      }
    }
    const std::vector<const std::vector<Pixel>*> around{&square(column - 1, row - 1), &square(column, row - 1),
                                                        &square(column - 1, row), &square(column, row)};
    if (const auto found = panel_corner(corner.id, corner.q, kReach * side, around)) {
      result.panel_corners.push_back(*found);
    }
  }

  // Evenly over the inner squares, which corners close on all sides.
  std::size_t total = 0;
  std::vector<const std::vector<Pixel>*> inner;
  for (int row = 1; row + 2 < lattice.rows(); ++row) {
    for (int column = 1; column + 2 < lattice.columns(); ++column) {
      inner.push_back(&square(column, row));
      total += inner.back()->size();
    }
  }
  if (total < kFewestPixels) {
    return fail(RCode::kTooFewCorrespondences, std::to_string(total) + " decoded pixels on the target, at least " +
                                                   std::to_string(kFewestPixels) + " are needed");
  }
  const std::size_t share = kPixelsPerView / inner.size() + 1;
  for (const auto* pixels : inner) {
    const std::size_t take = std::min(share, pixels->size());
    for (std::size_t i = 0; i < take; ++i) {
      const Pixel& pixel = (*pixels)[(2 * i + 1) * pixels->size() / (2 * take)];
      result.pixels.push_back({camera, pixel.q, pixel.x, std::sqrt(pixel.variance)});
    }
  }
  return result;
}

}  // namespace raysteer::calib::solve
