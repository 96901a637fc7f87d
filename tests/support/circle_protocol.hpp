// The checkerboard-and-circles protocol: a disc thrown into each white square of a printed board, and how far from the
// square's middle it falls, in a picture that the board itself rectifies. What the rig is calibrated from is not the
// judge.
//
// RMSE = sqrt(mean |u^ - u|^2), u^ a disc's middle, u its square's, on the board; px: of the panel, at the board.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "calib/scene/triangulate.hpp"
#include "calib/scene/two_views.hpp"
#include "calib/solve/closed_form.hpp"
#include "calib/steer/predict.hpp"
#include "calib/target/detect.hpp"
#include "host/session/image_codec.hpp"
#include "host/tour/show.hpp"

namespace raysteer::support {

struct CircleErrors {
  double rmse_mm = 0;
  double rmse_px = 0;
  int discs = 0;
};

namespace circles {

using Eigen::Vector2d;
using Eigen::Vector3d;

inline constexpr double kRadius = 0.28;  ///< of a disc, in squares

inline Result<Image<double>> grey(const std::filesystem::path& file) {
  const auto bytes = host::session::read_file(file);
  RAYSTEER_TRY(bytes);
  const auto frame = host::session::decode_image(*bytes);
  RAYSTEER_TRY(frame);
  return std::visit(
      [](const auto& pixels) {
        auto grey = Image<double>::uninitialised(pixels.width(), pixels.height());
        std::copy(pixels.data(), pixels.data() + pixels.size(), grey.data());
        return grey;
      },
      *frame);
}

/// Brightest pixel 255, as detectors of prints want it.
inline Image<std::uint8_t> stretched(const Image<double>& grey) {
  const double most = std::max(1.0, *std::max_element(grey.data(), grey.data() + grey.size()));
  auto bytes = Image<std::uint8_t>::uninitialised(grey.width(), grey.height());
  std::transform(grey.data(), grey.data() + grey.size(), bytes.data(),
                 [&](double value) { return static_cast<std::uint8_t>(255 * value / most); });
  return bytes;
}

/// Middles of the white squares, board frame: the one before corner 0 is black. Those of the rim count, too.
inline std::vector<Vector2d> white_squares(const TargetSpec& board) {
  std::vector<Vector2d> middles;
  for (int j = -1; j < board.rows; ++j) {
    for (int i = -1; i < board.columns; ++i) {
      if ((i + j) % 2 != 0) {
        middles.emplace_back(board.square_m * (i + 0.5), board.square_m * (j + 0.5));
      }
    }
  }
  return middles;
}

/// The board's pose by corners that both eyes see: Kabsch.
inline std::optional<calib::model::Pose> pose_of(const TargetSpec& board, const calib::model::Rig& cameras,
                                                 const std::array<calib::target::Detection, 2>& seen) {
  const auto views = calib::scene::two_views(cameras, 0, 1);
  if (!views) {
    return std::nullopt;
  }
  std::vector<Vector3d> on_board;
  std::vector<Vector3d> in_rig;
  for (const calib::target::Corner& left : seen[0].corners) {
    const auto right = std::ranges::find(seen[1].corners, left.id, &calib::target::Corner::id);
    if (right == seen[1].corners.end()) {
      continue;
    }
    const Eigen::Matrix2d cov = 0.0025 * Eigen::Matrix2d::Identity();
    const std::array match{
        calib::scene::Match{.q_left = left.q, .q_right = right->q, .cov_left = cov, .cov_right = cov}};
    if (const auto point = triangulate_one(*views, match[0], ray_pairs(*views, match)[0])) {
      on_board.push_back(calib::target::corner_position(board, left.id));
      in_rig.push_back(point->p);
    }
  }
  if (on_board.size() < 12) {
    return std::nullopt;
  }
  Eigen::Matrix3Xd from(3, on_board.size());
  Eigen::Matrix3Xd to(3, on_board.size());
  for (std::size_t k = 0; k < on_board.size(); ++k) {
    from.col(static_cast<Eigen::Index>(k)) = on_board[k];
    to.col(static_cast<Eigen::Index>(k)) = in_rig[k];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(from, to, false);
  return calib::model::Pose{Eigen::Quaterniond(Eigen::Matrix3d(T.topLeftCorner<3, 3>())), T.topRightCorner<3, 1>()};
}

/// A disc of the board as the panel must show it: its middle, and board metres per panel px there.
struct Disc {
  Vector2d x;
  Eigen::Matrix2d m_per_px;
};

inline std::optional<Disc> disc_at(const calib::model::VirtualProjector& light, const calib::model::Pose& T_rig_board,
                                   const Vector2d& middle, double step_m) {
  const auto at = [&](double u, double v) {
    return light.project(T_rig_board * Vector3d(middle.x() + u, middle.y() + v, 0));
  };
  const auto x = at(0, 0);
  const std::array around{at(step_m, 0), at(-step_m, 0), at(0, step_m), at(0, -step_m)};
  if (!x || !std::ranges::all_of(around, [](const auto& each) { return each.has_value(); })) {
    return std::nullopt;
  }
  Eigen::Matrix2d px_per_m;
  px_per_m << (*around[0] - *around[1]) / (2 * step_m), (*around[2] - *around[3]) / (2 * step_m);
  return Disc{*x, px_per_m.inverse()};
}

inline void draw(const Disc& disc, double radius_m, Image<std::uint8_t>& picture) {
  constexpr int kSamples = 8;
  const double reach = 1.5 * radius_m / std::sqrt(std::abs(disc.m_per_px.determinant()));
  const int top = std::max(0, static_cast<int>(disc.x.y() - reach));
  const int bottom = std::min(picture.height() - 1, static_cast<int>(disc.x.y() + reach) + 1);
  const int first = std::max(0, static_cast<int>(disc.x.x() - reach));
  const int last = std::min(picture.width() - 1, static_cast<int>(disc.x.x() + reach) + 1);
  for (int y = top; y <= bottom; ++y) {
    for (int x = first; x <= last; ++x) {
      int inside = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const Vector2d at(x + (k % kSamples + 0.5) / kSamples - 0.5, y + (k / kSamples + 0.5) / kSamples - 0.5);
        inside += (disc.m_per_px * (at - disc.x)).norm() < radius_m ? 1 : 0;
      }
      const double light = static_cast<double>(inside) / (kSamples * kSamples);
      // Light is proportional to code^2.2 (the boards' gamma).
      const auto code = static_cast<std::uint8_t>(std::lround(255 * std::pow(light, 1 / 2.2)));
      picture(x, y) = std::max(picture(x, y), code);
    }
  }
}

/// The middle of what is lit about pixel q: weighted by light, within `reach` px, above a tenth of the brightest.
inline std::optional<Vector2d> lit_middle(const Image<double>& lit, const Vector2d& q, double reach) {
  double brightest = 0;
  std::vector<std::pair<Vector2d, double>> near;
  for (int y = static_cast<int>(q.y() - reach); y <= q.y() + reach; ++y) {
    for (int x = static_cast<int>(q.x() - reach); x <= q.x() + reach; ++x) {
      if (x >= 0 && y >= 0 && x < lit.width() && y < lit.height() && (Vector2d(x, y) - q).norm() <= reach) {
        near.emplace_back(Vector2d(x, y), lit(x, y));
        brightest = std::max(brightest, lit(x, y));
      }
    }
  }
  double sum = 0;
  Vector2d middle = Vector2d::Zero();
  for (const auto& [at, light] : near) {
    if (light > 0.1 * brightest) {
      sum += light;
      middle += light * at;
    }
  }
  return brightest > 10 ? std::optional<Vector2d>(middle / sum) : std::nullopt;
}

}  // namespace circles

/// The board of `printed.toml`: 6 x 9 squares of 100 mm.
inline TargetSpec printed_board() {
  TargetSpec board;
  board.columns = 8;
  board.rows = 5;
  board.square_m = 0.1;
  return board;
}

/// `pretend`: a scene whose target lies on the floor in the light of `command_rad`. The left camera judges. Errors:
/// what is not found.
inline Result<CircleErrors> circle_errors(const host::sim::PretendOptions& pretend,
                                          const calib::steer::Solution& solution, const TargetSpec& board,
                                          const Eigen::Vector2d& command_rad, const std::filesystem::path& folder) {
  using namespace circles;
  const auto& lens = solution.projector.lens;
  host::tour::ShowRequest request;
  request.mirror_rad = {command_rad.x(), command_rad.y()};
  request.expose_for_first = true;
  std::vector<Image<std::uint8_t>> pictures;
  pictures.emplace_back(lens.width, lens.height).fill(0);
  const auto dark = host::tour::show(pretend, request, pictures, folder / "board", {});
  RAYSTEER_TRY(dark);
  std::array<calib::target::Detection, 2> seen;
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const auto frame = grey(dark->frames[eye][0]);
    RAYSTEER_TRY(frame);
    auto found = calib::target::detect(board, stretched(*frame).view());
    RAYSTEER_TRY(found);
    seen[eye] = *std::move(found);
  }
  const auto T_rig_board = pose_of(board, solution.cameras, seen);
  if (!T_rig_board) {
    return fail(RCode::kTargetNotFound, "the board's pose");
  }
  const calib::model::VirtualProjector light = solution.projector.at(command_rad);
  const std::vector<Vector2d> middles = white_squares(board);
  std::vector<Disc> discs;
  Image<std::uint8_t>& content = pictures.emplace_back(lens.width, lens.height);
  content.fill(0);
  for (const Vector2d& middle : middles) {
    const auto disc = disc_at(light, *T_rig_board, middle, 0.1 * board.square_m);
    if (!disc || disc->x.minCoeff() < 0 || disc->x.x() > lens.width - 1 || disc->x.y() > lens.height - 1) {
      return fail(RCode::kStationOutOfReach, "the light does not reach all of the board");
    }
    draw(*disc, kRadius * board.square_m, content);
    discs.push_back(*disc);
  }
  // Exposed for white, so that discs do not saturate; black beside it tells their light from the room's.
  request.expose_for_first = false;
  const auto shown = host::tour::show(pretend, request, pictures, folder / "discs", {});
  RAYSTEER_TRY(shown);
  auto lit = grey(shown->frames[0][1]);
  RAYSTEER_TRY(lit);
  const auto unlit = grey(shown->frames[0][0]);
  RAYSTEER_TRY(unlit);
  std::transform(lit->data(), lit->data() + lit->size(), unlit->data(), lit->data(), std::minus<>());

  const calib::model::Camera& camera = solution.cameras.devices[0].camera;
  std::vector<Vector2d> on_board;
  std::vector<Vector2d> on_image;
  for (const calib::target::Corner& corner : seen[0].corners) {
    on_board.emplace_back(calib::target::corner_position(board, corner.id).head<2>());
    on_image.push_back(camera.normalize(corner.q).value_or(Vector2d::Zero()));
  }
  const auto H = calib::solve::homography(on_image, on_board);
  if (!H) {
    return fail(RCode::kTargetNotFound, "the board's homography");
  }
  CircleErrors errors;
  double squared_mm = 0;
  double squared_px = 0;
  for (std::size_t k = 0; k < middles.size(); ++k) {
    const Vector3d p = *T_rig_board * Vector3d(middles[k].x(), middles[k].y(), 0);
    const auto q = camera.project(p);
    const auto q_next = camera.project(*T_rig_board * Vector3d(middles[k].x() + board.square_m, middles[k].y(), 0));
    const auto found = q && q_next ? lit_middle(*lit, *q, 0.5 * (*q_next - *q).norm()) : std::nullopt;
    const auto n = found ? camera.normalize(*found) : std::nullopt;
    if (!n) {
      return fail(RCode::kTargetNotFound, "a disc");
    }
    const Vector2d off = (*H * n->homogeneous()).hnormalized() - middles[k];
    squared_mm += 1e6 * off.squaredNorm();
    squared_px += (discs[k].m_per_px.inverse() * off).squaredNorm();
    ++errors.discs;
  }
  errors.rmse_mm = std::sqrt(squared_mm / errors.discs);
  errors.rmse_px = std::sqrt(squared_px / errors.discs);
  return errors;
}

}  // namespace raysteer::support
