#include "sim/world/world.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <list>
#include <utility>

#include "sim/optics/light_path.hpp"
#include "sim/world/bounce.hpp"
#include "sim/world/lamp.hpp"
#include "sim/world/lens_blur.hpp"
#include "sim/world/light.hpp"
#include "sim/world/lit.hpp"
#include "sim/world/panel_light.hpp"
#include "sim/world/rows.hpp"
#include "sim/world/seen.hpp"
#include "sim/world/shapes.hpp"

namespace raysteer::sim::world {

using Eigen::Vector2d;
using Eigen::Vector3d;
using hal::mock::Exposure;
using hal::mock::LightSpan;

namespace {

/// Looks are traced at angles on this grid, and the picture is moved by the few microradians that remain: a mirror that
/// trembles costs nothing, and no result depends on what was traced before.
constexpr double kAngleGrid = 10e-6;

double on_grid(Radians angle) { return std::round(angle.raw() / kAngleGrid) * kAngleGrid; }

hal::MirrorAngles on_grid(hal::MirrorAngles angles) {
  return {Radians(on_grid(angles.axis1)), Radians(on_grid(angles.axis2))};
}

double seconds(std::chrono::nanoseconds duration) { return std::chrono::duration<double>(duration).count(); }

/// How the panel moves over the room when the mirror turns a little: affine, from four places at the focus's distance.
Standing standing(const optics::TrueRig& rig, hal::MirrorAngles from, hal::MirrorAngles to, ProjectorPx drift) {
  Standing standing;
  standing.drift = drift;
  if (from == to) {
    return standing;
  }
  const optics::LightPath before(rig, from);
  const optics::LightPath after(rig, to);
  const double distance = rig.projector.focus_m > 0 ? rig.projector.focus_m : 2;
  Eigen::Matrix<double, 4, 3> places;
  Eigen::Matrix<double, 4, 2> moves;
  for (int i = 0; i < 4; ++i) {
    const Vector2d x((i % 2 == 0 ? 0.2 : 0.8) * rig.projector.width, (i < 2 ? 0.2 : 0.8) * rig.projector.height);
    const auto ray = before.leave(x);
    const auto moved = ray ? after.pixel(ray->origin + distance * ray->direction) : std::nullopt;
    places.row(i) << 1, x.x(), x.y();
    moves.row(i) = moved ? Eigen::RowVector2d((*moved - x).transpose()) : Eigen::RowVector2d::Zero();
  }
  const Eigen::Matrix<double, 3, 2> fit = (places.transpose() * places).inverse() * places.transpose() * moves;
  for (std::size_t i = 0; i < 3; ++i) {
    standing.move_x[i] = fit(static_cast<Eigen::Index>(i), 0);
    standing.move_y[i] = fit(static_cast<Eigen::Index>(i), 1);
  }
  return standing;
}

/// May a lens see into a box? Not when all its corners lie beyond one border of the picture, or behind the lens.
bool may_see(const Eigen::Isometry3d& T_lens_rig, const optics::Lens& lens, int width, int height,
             const std::array<Vector3d, 8>& corners) {
  // The pyramid of directions within the picture, with a tenth to spare for distortion and blur.
  const auto& numbers = lens.numbers();
  const Vector2d low = (Vector2d(-0.1 * width, -0.1 * height) - numbers.centre_px).cwiseQuotient(numbers.focal_px);
  const Vector2d high = (Vector2d(1.1 * width, 1.1 * height) - numbers.centre_px).cwiseQuotient(numbers.focal_px);
  std::array<int, 5> outside{};
  for (const Vector3d& corner : corners) {
    const Vector3d p = T_lens_rig * corner;
    outside[0] += p.z() <= 0 ? 1 : 0;
    outside[1] += p.x() < low.x() * p.z() ? 1 : 0;
    outside[2] += p.x() > high.x() * p.z() ? 1 : 0;
    outside[3] += p.y() < low.y() * p.z() ? 1 : 0;
    outside[4] += p.y() > high.y() * p.z() ? 1 : 0;
  }
  return std::none_of(outside.begin(), outside.end(), [&](int count) { return count == 8; });
}

/// One picture on the panel as one look's footprints see it.
struct Shining {
  std::shared_ptr<const Lit> lit;
  std::shared_ptr<const Bounce> bounce;  ///< nullptr: not asked for
  std::unique_ptr<const PanelLight> light;
  const LightSpan* span = nullptr;
  float weight = 0;
};

/// So many pixels beyond each border of a camera's picture its lens's blur brings light in.
int blur_margin(const optics::TrueCamera& camera) { return static_cast<int>(lens_blur(camera.blur_px).size()) - 1; }

/// The camera with a larger sensor, so that its blur has what lies just outside the picture.
optics::TrueCamera with_margin(optics::TrueCamera camera) {
  const int margin = blur_margin(camera);
  optics::LensNumbers numbers = camera.lens.numbers();
  numbers.centre_px += Vector2d(margin, margin);
  camera.lens = optics::Lens(numbers);
  camera.width += 2 * margin;
  camera.height += 2 * margin;
  return camera;
}

/// What comes in through a lens, blurred by it; without the margin. `lux_s`: ambient light times time.
Image<float> gather(const Seen& seen, double lux_s, const std::vector<Shining>& shining, int threads) {
  const int width = seen.width();
  const int height = seen.height();
  const std::vector<float> weights = lens_blur(seen.camera().blur_px);
  const auto ambient = static_cast<float>(lux_s);
  std::vector<std::pair<const Bounce*, std::vector<float>>> indirect;
  for (const Shining& one : shining) {
    if (one.bounce) {
      indirect.emplace_back(one.bounce.get(), std::vector<float>(one.bounce->nodes()));
      one.bounce->add(*one.span->picture, one.span->first_row, one.span->end_row, one.weight, indirect.back().second);
    }
  }
  Image<float> across = Image<float>::uninitialised(width, height);
  for_rows(height, threads, [&](int first, int end) {
    std::vector<float> sharp(static_cast<std::size_t>(width));
    std::vector<float> even(static_cast<std::size_t>(width), ambient);  // light from all around, lux seconds
    std::vector<float> bounced;
    for (int y = first; y < end; ++y) {
      if (!indirect.empty()) {
        std::fill(even.begin(), even.end(), ambient);
        for (const auto& [bounce, nodes] : indirect) {
          bounce->row(nodes, y, bounced);
          for (std::size_t x = 0; x < even.size(); ++x) {
            even[x] += bounced[x];
          }
        }
      }
      const Sight* sights = seen.row(y);
      for (std::size_t x = 0; x < even.size(); ++x) {
        sharp[x] = even[x] * sights[x].reflect;
      }
      for (const PartSight& part : seen.parts(y)) {
        const auto x = static_cast<std::size_t>(part.x);
        sharp[x] += even[x] * part.sight.reflect;
      }
      for (const Shining& one : shining) {
        one.light->add(one.lit->row(y), one.weight, sharp.data());
        one.light->add(one.lit->parts(y), one.weight, sharp.data());
      }
      blur_row(weights, sharp.data(), width, across.row(y));
    }
  });
  const int margin = blur_margin(seen.camera());
  Image<float> electrons = Image<float>::uninitialised(width - 2 * margin, height - 2 * margin);
  for_rows(electrons.height(), threads, [&](int first, int end) {
    for (int y = first; y < end; ++y) {
      float* out = electrons.row(y);
      const auto row = [&](int k) { return across.row(y + margin + k) + margin; };
      const float* here = row(0);
      for (int x = 0; x < electrons.width(); ++x) {
        out[x] = weights[0] * here[x];
      }
      for (int k = 1; k <= margin; ++k) {
        const float weight = weights[static_cast<std::size_t>(k)];
        const float* above = row(-k);
        const float* below = row(k);
        for (int x = 0; x < electrons.width(); ++x) {
          out[x] += weight * (above[x] + below[x]);
        }
      }
      // The blur's far ends dip a little below zero beside bright edges.
      for (int x = 0; x < electrons.width(); ++x) {
        out[x] = std::max(out[x], 0.0F);
      }
    }
  });
  return electrons;
}

/// A viewer's pinhole as a camera.
optics::TrueCamera viewer(const RoomView& view) {
  optics::TrueCamera camera;
  camera.name = "room";
  camera.width = view.width;
  camera.height = view.height;
  camera.lens = optics::Lens(
      {.focal_px = {view.focal_px, view.focal_px}, .centre_px = {(view.width - 1) / 2.0, (view.height - 1) / 2.0}});
  const Vector3d forward = (view.look_at - view.eye).normalized();
  Vector3d right = forward.cross(view.up);
  if (right.norm() < 1e-9) {
    right = forward.unitOrthogonal();
  }
  right.normalize();
  Eigen::Matrix3d R_camera_rig;
  R_camera_rig << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  camera.T_camera_rig.linear() = R_camera_rig;
  camera.T_camera_rig.translation() = -R_camera_rig * view.eye;
  camera.blur_px = 0.35;
  return camera;
}

}  // namespace

struct World::State {
  struct Look {
    hal::MirrorAngles mirror;
    std::shared_ptr<const Lit> lit;
    std::shared_ptr<const Bounce> bounce;
  };
  /// The room as rays see it, and what would make it another.
  struct Built {
    std::shared_ptr<const Shapes> shapes;
    std::uint64_t still_key = 0;
    std::vector<Vector3d> moving;
  };
  /// What one camera has traced; looks in the order of their last use, newest first.
  struct Traced {
    optics::TrueCamera camera;
    std::shared_ptr<const Shapes> shapes;
    std::unique_ptr<const Seen> seen;
    std::list<Look> looks;
  };

  optics::TrueRig rig;
  scene::Scene scene;
  WorldOptions options;
  int target_pose = 0;
  Built still;  ///< without what moves
  Built whole;
  std::shared_ptr<const Smooth> intensity;
  std::array<Traced, 2> eyes;
  Traced room;

  scene::Moment moment(RigTime time) const { return {.time = time, .target_pose = target_pose}; }

  /// `matters`: is what moves looked at? Asked with its corners in the rig's frame; when not, the still room will do.
  template <class Matters>
  const std::shared_ptr<const Shapes>& shapes_at(RigTime time, const Matters& matters) {
    const scene::Moment now = moment(time);
    const std::uint64_t key = scene::still_key(scene, now);
    std::vector<Vector3d> moving_now = scene::flatten(scene, now, scene::Which::kMoving).vertices;
    const bool moves = !moving_now.empty() && matters(box(moving_now));
    if (!moves) {
      moving_now.clear();
    }
    Built& built = moves ? whole : still;
    if (!built.shapes || key != built.still_key || moving_now != built.moving) {
      const auto which = moves ? scene::Which::kAll : scene::Which::kStill;
      built = {.shapes = std::make_shared<const Shapes>(scene, scene::flatten(scene, now, which)),
               .still_key = key,
               .moving = std::move(moving_now)};
    }
    return built.shapes;
  }

  /// The corners of the box around points of the room, in the rig's frame.
  std::array<Vector3d, 8> box(const std::vector<Vector3d>& points) const {
    Eigen::AlignedBox3d around;
    for (const Vector3d& p : points) {
      around.extend(p);
    }
    const Eigen::Isometry3d T_rig_room = scene.T_room_rig.inverse();
    std::array<Vector3d, 8> corners;
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] = T_rig_room * around.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    }
    return corners;
  }

  /// May something in a box be seen by this camera, or stand in the light of these spans?
  bool matters(const optics::TrueCamera& camera, const std::vector<LightSpan>& spans,
               const std::array<Vector3d, 8>& corners) const {
    if (options.interreflection || may_see(camera.T_camera_rig, camera.lens, camera.width, camera.height, corners)) {
      return true;
    }
    return std::any_of(spans.begin(), spans.end(), [&](const LightSpan& span) {
      return span.picture && may_see(optics::LightPath(rig, span.mirror).T_virtual_rig(), rig.projector.lens,
                                     rig.projector.width, rig.projector.height, corners);
    });
  }

  /// Traces what is not traced yet.
  const Seen& seen(Traced& traced, const std::shared_ptr<const Shapes>& shapes) const {
    if (!traced.seen || traced.shapes != shapes) {
      traced.looks.clear();
      traced.seen.reset();
      traced.shapes = shapes;
      traced.seen = std::make_unique<const Seen>(traced.camera, shapes, options.threads);
    }
    return *traced.seen;
  }

  const Look& look(Traced& traced, hal::MirrorAngles mirror) const {
    const auto known =
        std::find_if(traced.looks.begin(), traced.looks.end(), [&](const Look& look) { return look.mirror == mirror; });
    if (known != traced.looks.end()) {
      traced.looks.splice(traced.looks.begin(), traced.looks, known);
      return traced.looks.front();
    }
    // Make room first: two looks of a large camera are much memory.
    constexpr std::size_t kAlways = 2;
    std::size_t bytes = 0;
    std::size_t count = 1;
    for (auto kept = traced.looks.begin(); kept != traced.looks.end();) {
      bytes += kept->lit->bytes();
      ++count;
      kept = count > kAlways && 2 * bytes > options.cache_bytes ? traced.looks.erase(kept) : std::next(kept);
    }
    const Lamp lamp(rig, intensity, mirror);
    Look traced_now{
        .mirror = mirror, .lit = std::make_shared<const Lit>(*traced.seen, lamp, options.threads), .bounce = {}};
    if (options.interreflection) {
      traced_now.bounce = std::make_shared<const Bounce>(*traced.seen, lamp, rig.projector, options.threads);
    }
    traced.looks.push_front(std::move(traced_now));
    return traced.looks.front();
  }

  /// Spans that differ only in when they were are one.
  std::vector<Shining> shining(Traced& traced, const std::vector<LightSpan>& spans) const {
    std::vector<Shining> all;
    std::vector<const LightSpan*> done;
    for (const LightSpan& span : spans) {
      if (!span.picture || span.end_row <= span.first_row) {
        continue;
      }
      const auto weight = static_cast<float>(seconds(span.end - span.begin) * span.power);
      const auto same = std::find_if(done.begin(), done.end(), [&](const LightSpan* other) {
        return other->picture == span.picture && other->first_row == span.first_row && other->end_row == span.end_row &&
               other->drift == span.drift && other->mirror == span.mirror;
      });
      if (same != done.end()) {
        all[static_cast<std::size_t>(same - done.begin())].weight += weight;
        continue;
      }
      done.push_back(&span);
      const hal::MirrorAngles grid = on_grid(span.mirror);
      Shining one;
      const Look& at = look(traced, grid);
      one.lit = at.lit;
      one.bounce = at.bounce;
      one.span = &span;
      one.light = std::make_unique<const PanelLight>(*span.picture, span.first_row, span.end_row,
                                                     standing(rig, grid, span.mirror, span.drift), one.lit->levels(),
                                                     options.threads);
      one.weight = weight;
      all.push_back(std::move(one));
    }
    return all;
  }

  double ambient_lux_s(RigTime begin, std::chrono::nanoseconds duration) const {
    return scene.ambient.lux * flicker_integral(scene.ambient.flicker_depth, scene.ambient.flicker_hz, begin, duration);
  }
};

World::World(optics::TrueRig rig, scene::Scene scene, WorldOptions options) : state_(std::make_unique<State>()) {
  state_->eyes[0].camera = with_margin(rig.cameras[0]);
  state_->eyes[1].camera = with_margin(rig.cameras[1]);
  state_->intensity = std::make_shared<const Smooth>(intensity_map(rig.projector));
  state_->rig = std::move(rig);
  state_->scene = std::move(scene);
  state_->options = options;
}

World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;
World::~World() = default;

const optics::TrueRig& World::rig() const { return state_->rig; }
const scene::Scene& World::scene() const { return state_->scene; }
void World::set_target_pose(int pose) { state_->target_pose = pose; }

Image<float> World::draw(const Exposure& exposure) {
  State::Traced& eye = state_->eyes[exposure.eye == hal::Eye::kLeft ? 0 : 1];
  const auto& shapes = state_->shapes_at(exposure.begin + exposure.duration / 2, [&](const auto& box) {
    return state_->matters(eye.camera, exposure.light, box);
  });
  const Seen& seen = state_->seen(eye, shapes);
  return gather(seen, state_->ambient_lux_s(exposure.begin, exposure.duration), state_->shining(eye, exposure.light),
                state_->options.threads);
}

std::optional<LitPoint> World::lit_point(hal::MirrorAngles mirror, ProjectorPx x, RigTime at) {
  const optics::TrueProjector& projector = state_->rig.projector;
  if (!(x.x >= -0.5 && x.y >= -0.5 && x.x <= projector.width - 0.5 && x.y <= projector.height - 0.5)) {
    return {};
  }
  const Shapes& shapes = *state_->shapes_at(at, [](const auto&) { return true; });
  const auto ray = optics::LightPath(state_->rig, mirror).leave({x.x, x.y});
  if (!ray || !ray->passage.through) {
    return {};
  }
  const std::uint32_t triangle = shapes.tracer().nearest(ray->origin, ray->direction);
  if (triangle == Tracer::kNothing) {
    return {};
  }
  const double distance = shapes.tracer().meets(ray->origin, ray->direction, triangle);
  return LitPoint{.p = ray->origin + distance * ray->direction, .surface = shapes.surface(triangle)};
}

std::optional<ProjectorPx> World::panel_pixel(hal::MirrorAngles mirror, const Vector3d& p, RigTime at) {
  const Shapes& shapes = *state_->shapes_at(at, [](const auto&) { return true; });
  const auto by = optics::LightPath(state_->rig, mirror).lit_by(p);
  const optics::TrueProjector& projector = state_->rig.projector;
  if (!by || !by->passage.through ||
      !(by->x.x() >= -0.5 && by->x.y() >= -0.5 && by->x.x() <= projector.width - 0.5 &&
        by->x.y() <= projector.height - 0.5)) {
    return {};
  }
  constexpr double kNearM = 1e-4;
  const Vector3d way = (by->origin - p).normalized();
  if (shapes.tracer().blocked({(p + kNearM * way).cast<float>(), by->origin.cast<float>()})) {
    return {};
  }
  return ProjectorPx(by->x.x(), by->x.y());
}

Image<std::uint8_t> World::room_picture(const RoomView& view, const Exposure& exposure) {
  State::Traced& room = state_->room;
  room = {};
  room.camera = with_margin(viewer(view));
  const Seen& seen =
      state_->seen(room, state_->shapes_at(exposure.begin + exposure.duration / 2, [](const auto&) { return true; }));
  const std::vector<Shining> shining = state_->shining(room, exposure.light);

  // The eye adapts to the brightest the projector can do here, so that pictures of one room compare.
  double white = 0;
  for (const Shining& one : shining) {
    std::vector<float> gains;
    for (int y = 0; y < view.height; ++y) {
      for (const Footprint& print : one.lit->row(y)) {
        if (print.gain > 0) {
          gains.push_back(print.gain);
        }
      }
    }
    if (!gains.empty()) {
      const auto most = gains.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(gains.size() - 1));
      std::nth_element(gains.begin(), most, gains.end());
      white = std::max(white, one.weight * static_cast<double>(*most));
    }
  }
  std::vector<float> reflects;
  for (int y = 0; y < view.height; ++y) {
    for (int x = 0; x < view.width; ++x) {
      if (seen.row(y)[x].reflect > 0) {
        reflects.push_back(seen.row(y)[x].reflect);
      }
    }
  }
  double reflect = 0;
  if (!reflects.empty()) {
    const auto most = reflects.begin() + static_cast<std::ptrdiff_t>(0.98 * static_cast<double>(reflects.size() - 1));
    std::nth_element(reflects.begin(), most, reflects.end());
    reflect = *most;
  }
  // ... and sees the room even where only the projector shines: stray light of a fifth of that.
  constexpr double kStray = 0.2;
  double lux_s = state_->ambient_lux_s(exposure.begin, exposure.duration);
  if (reflect > 0) {
    lux_s = std::max(lux_s, kStray * white / reflect);
  }
  const double brightest = white + lux_s * reflect;
  const Image<float> light = gather(seen, lux_s, shining, state_->options.threads);
  Image<std::uint8_t> picture = Image<std::uint8_t>::uninitialised(view.width, view.height);
  for (std::size_t i = 0; i < light.size(); ++i) {
    const double share = brightest > 0 ? std::clamp(light.data()[i] / brightest, 0.0, 1.0) : 0;
    picture.data()[i] = static_cast<std::uint8_t>(std::lround(255 * std::pow(share, 1 / 2.2)));
  }
  room = {};
  return picture;
}

std::optional<Vector2d> room_pixel(const RoomView& view, const Vector3d& p) { return viewer(view).project(p); }

}  // namespace raysteer::sim::world
