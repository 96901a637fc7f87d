#include "sim/scene/texture.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace raysteer::sim::scene {
namespace {

double mix(const Ink& ink, double black_share) { return ink.white + (ink.black - ink.white) * black_share; }

// One axis of a chessboard, averaged over a stretch: the share that lies on squares, and the mean there of a wave that
// is +1 on even squares, -1 on odd ones and 0 beyond.
struct Stretch {
  double covered = 0;
  double wave = 0;
};

Stretch stretch(double middle, double length, int corners, double square) {
  const double least = -square;
  const double most = corners * square;
  if (length <= 0) {
    const bool inside = middle >= least && middle < most;
    const bool even = std::fmod(std::floor(middle / square), 2.0) == 0;
    return {.covered = inside ? 1.0 : 0.0, .wave = inside ? (even ? 1.0 : -1.0) : 0.0};
  }
  // The wave's integral is a row of triangles.
  const auto integral = [&](double x) {
    const double phase = x - 2 * square * std::floor(x / (2 * square));
    return std::min(phase, 2 * square - phase);
  };
  const double from = std::clamp(middle - length / 2, least, most);
  const double to = std::clamp(middle + length / 2, least, most);
  return {.covered = (to - from) / length, .wave = (integral(to) - integral(from)) / length};
}

double albedo_of(const Chessboard& board, const Eigen::Vector2d& uv, const Eigen::Vector2d& size) {
  const Stretch u = stretch(uv.x(), size.x(), board.columns, board.square_m);
  const Stretch v = stretch(uv.y(), size.y(), board.rows, board.square_m);
  // A square is black where both waves have the same sign: (1 + wave wave) / 2, averaged over what is covered.
  return mix(board.ink, (u.covered * v.covered + u.wave * v.wave) / 2);
}

double albedo_at(const RingDatum& datum, const Eigen::Vector2d& uv) {
  const double radii = uv.norm() / datum.radius_m;
  bool white = radii < 1;
  if (radii >= 2 && radii < 3) {
    const double turn = std::atan2(uv.y(), uv.x()) / (2 * std::numbers::pi);
    const int sector = std::min(static_cast<int>((turn < 0 ? turn + 1 : turn) * datum.bits), datum.bits - 1);
    white = ((datum.code >> sector) & 1U) != 0;
  }
  return white ? datum.ink.white : datum.ink.black;
}

double albedo_at(const Picture& picture, const Eigen::Vector2d& uv) {
  const auto index = [&](double at, int count) {
    return std::clamp(static_cast<int>(std::floor(std::clamp(at / picture.pixel_m, -1.0, 1e9))), 0, count - 1);
  };
  return (*picture.albedo)(index(uv.x(), picture.albedo->width()), index(uv.y(), picture.albedo->height()));
}

template <class Kind>
double albedo_of(const Kind& kind, const Eigen::Vector2d& uv, const Eigen::Vector2d& size) {
  if (size.isZero(0)) {
    return albedo_at(kind, uv);
  }
  constexpr int kSamples = 4;
  double sum = 0;
  for (int j = 0; j < kSamples; ++j) {
    for (int i = 0; i < kSamples; ++i) {
      sum += albedo_at(kind,
                       uv + size.cwiseProduct(Eigen::Vector2d((i + 0.5) / kSamples - 0.5, (j + 0.5) / kSamples - 0.5)));
    }
  }
  return sum / (kSamples * kSamples);
}

}  // namespace

double Texture::albedo(const Eigen::Vector2d& uv, const Eigen::Vector2d& size) const {
  return std::visit([&](const auto& kind) { return albedo_of(kind, uv, size); }, kind_);
}

}  // namespace raysteer::sim::scene
