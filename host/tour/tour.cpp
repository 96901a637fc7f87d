#include "host/tour/tour.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "calib/bake/corner_covariance.hpp"
#include "calib/bake/metric_rectangle.hpp"
#include "calib/bake/test_card.hpp"
#include "calib/look/solve_look.hpp"
#include "calib/solve/solve.hpp"
#include "calib/target/detect.hpp"
#include "calib/target/discs.hpp"
#include "host/calibrate/gather.hpp"
#include "host/exchange/write_file.hpp"
#include "host/session/image_codec.hpp"
#include "host/session/session.hpp"
#include "host/sim/find_file.hpp"
#include "host/tour/before_after.hpp"
#include "host/tour/show.hpp"
#include "proto/board/board.hpp"
#include "proto/plan/plan.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::host::tour {
namespace {

namespace bake = calib::bake;
namespace look = calib::look;
namespace model = calib::model;
namespace target = calib::target;

constexpr double kWidth = 0.5;      // metres
constexpr double kHeight = 0.3125;  // as in algorithms 10.4
constexpr int kDiscsAcross = 9;
constexpr std::size_t kMostPoses = 10;  // of the plan's: more cost seconds each and are not what limits the corners

Status poll(const sim::Listener& listener) {
  return listener.cancelled && listener.cancelled() ? Status(fail(RCode::kCancelled)) : ok();
}

/// Cameras as calibrated from pictures of a waved board, and what is known of the projector before.
struct Prepared {
  proto::board::Board board;
  TargetSpec target;
  calib::solve::Solution cameras;
};

Image<std::uint8_t> uniform(const proto::board::Projector& projector, std::uint8_t grey) {
  Image<std::uint8_t> picture(projector.width, projector.height);
  picture.fill(grey);
  return picture;
}

/// The text of a board or a plan, by name or file; `file` becomes its path.
Result<std::string> text_of(const std::string& kind, const std::string& name, std::string& file) {
  const auto found = sim::find_file(kind, name);
  if (!found) {
    return found.error();
  }
  file = found->string();
  return exchange::read_file(*found);
}

/// The board in each of the plan's poses, by the room's light alone: the projector's would light a part of it, and that
/// too brightly. A session, so that it is calibrated from as any other.
Status wave(const TourOptions& options, const proto::board::Board& board, const sim::Listener& listener) {
  std::string file;
  const auto text = text_of("plans", options.plan, file);
  if (!text) {
    return text.error();
  }
  const auto plan = proto::plan::read_plan(*text, file);
  if (!plan) {
    return plan.error();
  }
  if (plan->targets.empty()) {
    return fail(RCode::kMissingKey, file + ": no [[target]]");
  }
  proto::session::Manifest manifest;
  manifest.name = "cameras";
  manifest.sequence = {.panel_width = board.projector.width,
                       .panel_height = board.projector.height,
                       .blocks = {{.kind = PatternKind::kBlack}}};
  manifest.targets = {{.spec = plan->targets.front().spec, .looks = {}}};
  for (const proto::board::Camera& camera : board.cameras) {
    manifest.cameras.push_back({.name = camera.name,
                                .files = camera.name + "/{look}.raw",
                                .first_index = 0,
                                .width = camera.width,
                                .height = camera.height,
                                .bits = camera.bits <= 8 ? 8 : 16});
  }
  ShowRequest request;
  request.mirror_rad = options.mirror_rad;
  request.prepare.clear();
  request.expose_for_first = true;
  std::vector<Image<std::uint8_t>> pictures;
  for (std::size_t i = 0; i < std::min(kMostPoses, plan->looks.size()); ++i) {
    request.prepare.push_back(plan->looks[i].prepare);
    manifest.looks.push_back({.name = std::to_string(i), .command = {}, .note = plan->looks[i].prepare});
    pictures.push_back(uniform(board.projector, 0));
  }
  const std::filesystem::path folder = options.folder / "cameras";
  const auto shown = show(options.pretend, request, pictures, folder, listener);
  if (!shown) {
    return shown.error();
  }
  return exchange::write_file(folder / "session.toml", proto::session::write_manifest(manifest));
}

Result<Prepared> prepare(const TourOptions& options, const sim::Listener& listener) {
  std::string file;
  const auto text = text_of("boards", options.pretend.board, file);
  if (!text) {
    return text.error();
  }
  auto board = proto::board::read_board(*text, file);
  if (!board) {
    return std::move(board).error();
  }
  RAYSTEER_TRY(wave(options, *board, listener));
  const auto session = session::Session::open(options.folder / "cameras" / "session.toml");
  if (!session) {
    return session.error();
  }
  const auto gathered = calibrate::gather_cameras(*session, [&](double done) {
    if (listener.progress) {
      listener.progress("finding boards", done);
    }
    return poll(listener).has_value();
  });
  if (!gathered) {
    return gathered.error();
  }
  if (gathered->observations.devices.size() != 2) {
    return fail(RCode::kCameraCount, "the tour needs two cameras");
  }
  calib::solve::SolveOptions solving;
  solving.lens = model::LensModel::kBc4;  // as boards draw lenses; choosing among models takes a minute on some rigs
  solving.progress = [&](std::string_view, double done) {
    if (listener.progress) {
      listener.progress("calibrating cameras", done);
    }
  };
  auto cameras = calib::solve::solve(gathered->observations, solving);
  if (!cameras) {
    return std::move(cameras).error();
  }
  return Prepared{*std::move(board), gathered->observations.target, *std::move(cameras)};
}

model::Camera drawing_of(const proto::board::Projector& projector) {
  model::Camera drawing{.width = projector.width,
                        .height = projector.height,
                        .fx = projector.lens.focal_px,
                        .fy = projector.lens.focal_px,
                        .cx = projector.lens.centre_px[0],
                        .cy = projector.lens.centre_px[1]};
  std::ranges::copy(projector.lens.distortion, drawing.k.begin());
  return drawing;
}

look::LensPrior prior_of(const proto::board::Tolerance& tolerance) {
  look::LensPrior prior;
  prior.focal = std::max(tolerance.focal, 1e-3);
  prior.centre = std::max(tolerance.centre, 1e-3);
  prior.radial = std::max(tolerance.distortion, 1e-3);
  return prior;
}

Result<Frame> frame_of(const std::filesystem::path& file) {
  const auto bytes = session::read_file(file);
  if (!bytes) {
    return bytes.error();
  }
  auto frame = session::decode_image(*bytes);
  return frame ? std::move(frame) : Result<Frame>(with_context(frame.error(), file.string()));
}

/// 8 bits, the brightest pixel 255: the board's contrast matters, not its grey.
Image<std::uint8_t> stretched(const Frame& frame) {
  return std::visit(
      [](const auto& pixels) {
        const int brightest =
            std::max(1, static_cast<int>(*std::max_element(pixels.data(), pixels.data() + pixels.size())));
        auto grey = Image<std::uint8_t>::uninitialised(pixels.width(), pixels.height());
        std::transform(pixels.data(), pixels.data() + pixels.size(), grey.data(),
                       [&](int value) { return static_cast<std::uint8_t>(255 * value / brightest); });
        return grey;
      },
      frame);
}

/// What one eye sees of the board and the discs. `files`: black, white, then the grid's pictures.
Result<look::Sight> sight_of(const Prepared& prepared, const target::DiscGrid& grid, std::size_t eye,
                             const std::vector<std::filesystem::path>& files) {
  std::vector<Frame> frames;
  for (const auto& file : files) {
    auto frame = frame_of(file);
    if (!frame) {
      return std::move(frame).error();
    }
    frames.push_back(*std::move(frame));
  }
  const model::Device& device = prepared.cameras.rig.devices[eye];
  look::Sight sight{.camera = device.camera, .T_camera_rig = device.T_device_rig, .corners = {}, .discs = {}};
  // By the room's light alone, without the picture's edges across the board.
  const auto board = target::detect(prepared.target, stretched(frames[0]).view());
  if (!board) {
    return with_context(board.error(), "the board on the floor, camera '" + device.name + "'");
  }
  sight.corners = board->corners;
  auto discs = target::detect_discs(grid, frames[0], frames[1], std::span(frames).subspan(2));
  if (!discs) {
    return with_context(discs.error(), "camera '" + device.name + "'");
  }
  sight.discs = *std::move(discs);
  return sight;
}

/// The projector posed against the floor.
struct Posed {
  look::Input input;
  look::Solution solution;
};

Result<Posed> pose(const TourOptions& options, const Prepared& prepared, const sim::Listener& listener) {
  const proto::board::Projector& projector = prepared.board.projector;
  const target::DiscGrid grid = target::fill_panel(projector.width, projector.height, kDiscsAcross);
  std::vector<Image<std::uint8_t>> pictures;
  pictures.push_back(uniform(projector, 0));
  pictures.push_back(uniform(projector, 255));
  for (int i = 0; i < grid.pictures(); ++i) {
    pictures.push_back(target::disc_picture(grid, projector.width, projector.height, i));
  }
  ShowRequest request;
  request.mirror_rad = options.mirror_rad;
  const auto shown = show(options.pretend, request, pictures, options.folder / "discs", listener);
  if (!shown) {
    return shown.error();
  }
  std::array<std::optional<Result<look::Sight>>, 2> seen;
  {
    std::array<std::jthread, 2> threads;
    for (std::size_t eye = 0; eye < 2; ++eye) {
      threads[eye] = std::jthread([&, eye] { seen[eye] = sight_of(prepared, grid, eye, shown->frames[eye]); });
    }
  }
  Posed posed{.input = {.target = prepared.target,
                        .grid = grid,
                        .sights = {},
                        .drawing = drawing_of(projector),
                        .prior = prior_of(prepared.board.tolerance)},
              .solution = {}};
  for (auto& sight : seen) {
    if (!*sight) {
      return std::move(*sight).error();
    }
    posed.input.sights.push_back(**std::move(sight));
  }
  auto solution = look::solve_look(posed.input);
  if (!solution) {
    return std::move(solution).error();
  }
  posed.solution = *std::move(solution);
  return posed;
}

/// From the plane's origin to the middle of the light, level to the camera and down, in whole centimetres: what can be
/// said in words, and what the truth is asked for.
Result<Eigen::Vector2d> middle_of_light(const look::Solution& solution) {
  const model::Camera& lens = solution.panel.lens;
  const auto p = solution.panel.on_plane({0.5 * (lens.width - 1), 0.5 * (lens.height - 1)});
  if (!p) {
    return fail(RCode::kBadValue, "the middle of the picture does not meet the floor");
  }
  const bake::MetricRectangle axes{.corner = Eigen::Vector2d::Zero(), .along = bake::level_axis(solution.T_rig_plane)};
  return Eigen::Vector2d((100 * axes.content(*p)).array().round() / 100);
}

/// Panel pixels of the rectangle's corners in the baked picture.
Result<std::array<Eigen::Vector2d, 4>> corners_on_panel(const look::Solution& solution,
                                                        const bake::MetricRectangle& rectangle) {
  std::array<Eigen::Vector2d, 4> pixels;
  const auto corners = rectangle.corners();
  for (std::size_t i = 0; i < 4; ++i) {
    const auto x = solution.panel.on_panel(corners[i]);
    const model::Camera& lens = solution.panel.lens;
    if (!x || x->minCoeff() < 0 || x->x() > lens.width - 1 || x->y() > lens.height - 1) {
      return fail(RCode::kBadValue, "the rectangle of 50 x 31.25 cm does not fit into the light of this look");
    }
    pixels[i] = *x;
  }
  return pixels;
}

using Misses = std::array<Eigen::Vector2d, 4>;

/// Landed minus wanted, on the true floor: the same words (so many centimetres from the board's corner, level to the
/// camera) said of the rig as it truly is.
Result<Misses> misses(const Shown& shown, std::size_t first, const Eigen::Vector2d& middle) {
  if (!shown.T_rig_target) {
    return fail(RCode::kBadValue, "the scene has no board on its floor");
  }
  const model::Pose& T_rig_plane = *shown.T_rig_target;
  const auto wanted = bake::level_rectangle(T_rig_plane, middle, kWidth, kHeight).corners();
  const model::Pose T_plane_rig = T_rig_plane.inverse();
  Misses all;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& lit = shown.lit_points[first + i];
    if (!lit) {
      return fail(RCode::kBadValue, "a corner of the rectangle lands nowhere");
    }
    all[i] = (T_plane_rig * *lit).head<2>() - wanted[i];
  }
  return all;
}

double mean_mm(const Misses& all) {
  double sum = 0;
  for (const Eigen::Vector2d& miss : all) {
    sum += 1e3 * miss.norm() / 4;
  }
  return sum;
}

double max_mm(const Misses& all) {
  double most = 0;
  for (const Eigen::Vector2d& miss : all) {
    most = std::max(most, 1e3 * miss.norm());
  }
  return most;
}

Result<Image<std::uint8_t>> grey_of(const std::filesystem::path& file) {
  auto frame = frame_of(file);
  if (!frame) {
    return std::move(frame).error();
  }
  auto* grey = std::get_if<Image<std::uint8_t>>(&*frame);
  if (grey == nullptr) {
    return fail(RCode::kFrameDepth, file.string() + " is no 8-bit picture");
  }
  return std::move(*grey);
}

std::string millimetres(double value) { return fmt::format("{:.{}f} mm", value, value < 10 ? 2 : 0); }

}  // namespace

Result<TourResult> tour(const TourOptions& options, const sim::Listener& listener) {
  const auto prepared = prepare(options, listener);
  if (!prepared) {
    return prepared.error();
  }
  RAYSTEER_TRY(poll(listener));
  const auto posed = pose(options, *prepared, listener);
  if (!posed) {
    return posed.error();
  }
  RAYSTEER_TRY(poll(listener));
  const look::Solution& solution = posed->solution;
  const proto::board::Projector& projector = prepared->board.projector;

  const auto middle = middle_of_light(solution);
  if (!middle) {
    return middle.error();
  }
  const bake::MetricRectangle rectangle = bake::level_rectangle(solution.T_rig_plane, *middle, kWidth, kHeight);
  const auto baked_corners = corners_on_panel(solution, rectangle);
  if (!baked_corners) {
    return baked_corners.error();
  }
  const auto sent = bake::unwarped(solution.panel, rectangle, projector.focus_m / projector.lens.focal_px);
  if (!sent) {
    return fail(RCode::kBadValue, "the rectangle's middle is not before the projector");
  }

  const bake::TestCard card{.width_m = kWidth, .height_m = kHeight};
  std::vector<Image<std::uint8_t>> pictures;
  pictures.push_back(bake::panel_picture(
      card, [&](const Eigen::Vector2d& x) { return std::optional(sent->content(x)); }, projector.width,
      projector.height, projector.gamma));
  pictures.push_back(bake::panel_picture(
      card, [&](const Eigen::Vector2d& x) { return bake::content_at(solution.panel, rectangle, x); }, projector.width,
      projector.height, projector.gamma));
  ShowRequest request;
  request.mirror_rad = options.mirror_rad;
  request.photograph = false;
  request.room = view_of(solution.T_rig_plane, rectangle);
  for (const Eigen::Vector2d& corner : rectangle.corners()) {
    request.panel_pixels.push_back(sent->on_panel(rectangle.content(corner)));
  }
  request.panel_pixels.insert(request.panel_pixels.end(), baked_corners->begin(), baked_corners->end());
  const auto shown = show(options.pretend, request, pictures, options.folder / "rectangle", listener);
  if (!shown) {
    return shown.error();
  }

  const auto before = misses(*shown, 0, *middle);
  if (!before) {
    return before.error();
  }
  const auto after = misses(*shown, 4, *middle);
  if (!after) {
    return after.error();
  }
  TourResult result;
  Eigen::Matrix<double, 8, 1> errors;
  for (std::size_t i = 0; i < 4; ++i) {
    result.corners_mm[i] = 1e3 * (*after)[i].norm();
    result.sides_mm[i] = 1e3 * (*shown->lit_points[4 + (i + 1) % 4] - *shown->lit_points[4 + i]).norm();
    errors.segment<2>(2 * static_cast<Eigen::Index>(i)) = (*after)[i];
  }
  result.corner_mean_mm = mean_mm(*after);
  result.corner_max_mm = max_mm(*after);
  result.before_mean_mm = mean_mm(*before);
  result.before_max_mm = max_mm(*before);
  const Eigen::Matrix<double, 8, 8> covariance = bake::corner_covariance(
      solution, look::with_cameras(posed->input, solution, prepared->cameras.rig), *middle, kWidth, kHeight);
  for (Eigen::Index i = 0; i < 4; ++i) {
    // The mean of a Rayleigh variable, as if both directions were alike.
    result.predicted_mean_mm +=
        1e3 / 4 * std::sqrt(std::numbers::pi / 4 * covariance.block<2, 2>(2 * i, 2 * i).trace());
  }
  result.chi_square = errors.dot(covariance.ldlt().solve(errors));
  result.leave_one_out_mm = solution.leave_one_out_mm;
  result.camera_rms_px = prepared->cameras.rms_px;
  result.corner_rms_px = solution.corner_rms_px;
  result.disc_rms_px = solution.disc_rms_px;
  result.discs = solution.discs;
  result.left_out = solution.left_out;
  result.mirrored = solution.panel.mirrored;
  result.middle_m = {middle->x(), middle->y()};

  std::array<Image<std::uint8_t>, 2> rooms;
  for (std::size_t i = 0; i < 2; ++i) {
    auto room = grey_of(shown->room[i]);
    if (!room) {
      return std::move(room).error();
    }
    rooms[i] = *std::move(room);
  }
  const std::string png =
      before_after_png({.before = rooms[0].view(),
                        .after = rooms[1].view(),
                        .before_words = "Before: sent straight, corners " + millimetres(result.before_mean_mm) + " off",
                        .after_words = "After: baked, corners " + millimetres(result.corner_mean_mm) +
                                       " off (at most " + millimetres(result.corner_max_mm) + ")"},
                       *request.room, solution.T_rig_plane, rectangle);
  result.picture = options.folder / "before-after.png";
  RAYSTEER_TRY(exchange::write_file(result.picture, png));
  return result;
}

}  // namespace raysteer::host::tour
