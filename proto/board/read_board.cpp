#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "proto/board/board.hpp"
#include "proto/document/fixed_numbers.hpp"
#include "proto/document/parse.hpp"

namespace raysteer::proto::board {

using document::Faults;
using document::Range;
using document::read_numbers;
using document::TomlTable;
namespace {

constexpr double kMilli = 1e-3;
constexpr double kMicro = 1e-6;
constexpr double kDegree = std::numbers::pi / 180;
constexpr Range<std::int64_t> kSide{1, 65535};
constexpr Range<double> kPlace{-100, 100};
constexpr std::string_view kMetres = "lengths are in metres (25 mm is 0.025)";

template <std::size_t count>
std::array<double, count> scaled(std::array<double, count> values, double factor) {
  for (double& value : values) {
    value *= factor;
  }
  return values;
}

Vec3 read_place(TomlTable& table, std::string_view key) {
  return read_numbers<3>(table, key, kPlace, nullptr, kMetres);
}

// People write 0.7071: a length within a percent of 1 is made 1.
Vec3 read_direction(TomlTable& table, std::string_view key) {
  Vec3 direction = read_numbers<3>(table, key, {-1.01, 1.01});
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (std::abs(length - 1) > 0.01) {
    table.fault(RCode::kBadValue, key, "must be a direction of length 1, got length " + std::to_string(length));
    return {0, 0, 1};
  }
  return scaled(direction, 1 / length);
}

// { rotation_deg = [x, y, z], translation_m = [x, y, z] }: a rotation vector, and where from's origin is seen.
Pose read_pose(TomlTable& parent, std::string_view key) {
  Pose pose;
  if (!parent.has(key)) {
    parent.table(key);  // known
    parent.fault(RCode::kMissingKey, key, "is needed: { rotation_deg = [...], translation_m = [...] }");
    return pose;
  }
  if (auto table = parent.table(key)) {
    constexpr Vec3 kZero{};
    pose.rotation = scaled(read_numbers<3>(*table, "rotation_deg", {-180, 180}, &kZero), kDegree);
    pose.translation = read_numbers<3>(*table, "translation_m", kPlace, &kZero, kMetres);
    table->finish();
  }
  return pose;
}

Lens read_lens(TomlTable& table) {
  constexpr std::array<double, 4> kNone{};
  Lens lens;
  lens.focal_px = table.number("focal_px", {10, 1e6});
  lens.centre_px = read_numbers<2>(table, "centre_px", {-1e5, 1e5});
  lens.distortion = read_numbers<4>(table, "distortion", {-10, 10}, &kNone);
  return lens;
}

Projector read_projector(TomlTable& table) {
  Projector projector;
  projector.kind = table.choice("kind", {"display", "trigger-master"}) == 0 ? ProjectorKind::kDisplay
                                                                            : ProjectorKind::kTriggerMaster;
  projector.width = static_cast<int>(table.integer("width", kSide));
  projector.height = static_cast<int>(table.integer("height", kSide));
  projector.frame_rate_hz = table.number("frame_rate_hz", {1, 1000}, projector.frame_rate_hz);
  projector.lens = read_lens(table);
  projector.T_projector_rig = read_pose(table, "T_projector_rig");
  projector.lumens = table.number("lumens", {1, 1e6});
  projector.focus_m = table.number("focus_m", {0.01, 1000}, {}, kMetres);
  projector.pupil_m = table.number("pupil_m", {0, 1}, {}, kMetres);
  projector.gamma = table.number("gamma", {0.1, 5}, projector.gamma);
  table.finish();
  return projector;
}

MirrorPlane read_plane(TomlTable& table) {
  MirrorPlane plane;
  plane.axis = read_direction(table, "axis");
  plane.point = read_place(table, "point_m");
  plane.normal = read_direction(table, "normal");
  plane.offset_m = table.number("offset_m", {-1, 1}, 0.0, kMetres);
  plane.size_m = read_numbers<2>(table, "size_m", {1e-3, 10}, nullptr, kMetres);
  plane.ellipse = table.choice("outline", {"ellipse", "rectangle"}, 0) == 0;
  table.finish();
  return plane;
}

void read_mirror_limits(TomlTable& table, Mirror& mirror) {
  constexpr Range<double> kAngle{-3200, 3200};
  constexpr std::string_view kMrad = "angles are in milliradians (1 degree is 17.45)";
  mirror.half_range_rad = scaled(read_numbers<2>(table, "half_range_mrad", {0.1, kAngle.most}, nullptr, kMrad), kMilli);
  mirror.least_rad = scaled(read_numbers<2>(table, "min_angle_mrad", kAngle, nullptr, kMrad), kMilli);
  mirror.most_rad = scaled(read_numbers<2>(table, "max_angle_mrad", kAngle, nullptr, kMrad), kMilli);
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (!(mirror.least_rad[axis] <= mirror.most_rad[axis])) {
      table.fault(RCode::kBadValue, "max_angle_mrad", "must not be below 'min_angle_mrad' on any axis");
    }
  }
  mirror.settle_tolerance_rad = table.number("settle_tolerance_urad", {1, 1e5}) * kMicro;
  mirror.settle_window_s = table.number("settle_window_us", {0, 1e7}) * kMicro;
  mirror.settle_timeout_s = table.number("settle_timeout_us", {1, 1e8}) * kMicro;
}

Mirror read_mirror(TomlTable& table, const Faults& faults) {
  Mirror mirror;
  mirror.kind = table.choice("kind", {"galvo-pair", "head"}) == 0 ? MirrorKind::kGalvoPair : MirrorKind::kHead;
  if (faults.any()) {
    return mirror;  // without its kind, nobody knows which keys belong here
  }
  mirror.preset = table.text("preset");
  read_mirror_limits(table, mirror);
  if (mirror.kind == MirrorKind::kHead) {
    mirror.outer_axis = read_direction(table, "outer_axis");
    mirror.outer_point = read_place(table, "outer_point_m");
  }
  for (TomlTable& plane : table.tables("plane")) {
    mirror.planes.push_back(read_plane(plane));
  }
  const std::size_t wanted = mirror.kind == MirrorKind::kGalvoPair ? 2 : 1;
  if (!table.has("plane")) {
    table.fault(RCode::kMissingKey, "plane", "is needed: [[mirror.plane]]");
  } else if (mirror.planes.size() != wanted) {
    table.fault(RCode::kBadValue, "plane",
                "must be " + std::to_string(wanted) + " for this kind, got " + std::to_string(mirror.planes.size()));
  }
  table.finish();
  return mirror;
}

Camera read_camera(TomlTable& table, bool is_left) {
  Camera camera;
  camera.name = table.text("name");
  camera.serial = table.text("serial", "");
  camera.width = static_cast<int>(table.integer("width", kSide));
  camera.height = static_cast<int>(table.integer("height", kSide));
  camera.bits = static_cast<int>(table.integer("bits", {8, 16}, camera.bits));
  camera.lens = read_lens(table);
  if (is_left && !table.has("T_camera_rig")) {
    table.table("T_camera_rig");  // known: the rig's frame is the left camera's
  } else {
    camera.T_camera_rig = read_pose(table, "T_camera_rig");
  }
  if (is_left && camera.T_camera_rig != Pose{}) {
    table.fault(RCode::kBadValue, "T_camera_rig", "must be left out: the rig's frame is the left camera's");
  }
  camera.f_number = table.number("f_number", {0.5, 64});
  camera.pixel_m = table.number("pixel_um", {0.5, 100}, {}, "the pitch in micrometres") * kMicro;
  camera.full_well_e = table.number("full_well_e", {100, 1e7});
  camera.read_noise_e = table.number("read_noise_e", {0, 1000});
  camera.quantum_efficiency = table.number("quantum_efficiency", {0.01, 1});
  camera.least_exposure_s = table.number("min_exposure_us", {1, 1e7}) * kMicro;
  camera.most_exposure_s = table.number("max_exposure_us", {1, 1e8}) * kMicro;
  camera.least_period_s = table.number("min_period_us", {1, 1e8}) * kMicro;
  if (!(camera.least_exposure_s <= camera.most_exposure_s)) {
    table.fault(RCode::kBadValue, "max_exposure_us", "must not be below 'min_exposure_us'");
  }
  table.finish();
  return camera;
}

Tolerance read_tolerance(TomlTable& table) {
  constexpr Range<double> kShare{0, 0.5};
  constexpr Range<double> kMrad{0, 500};
  constexpr Range<double> kLength{0, 1};
  Tolerance tolerance;
  tolerance.axis_rad = table.number("axis_mrad", kMrad, 0.0) * kMilli;
  tolerance.position_m = table.number("position_m", kLength, 0.0, kMetres);
  tolerance.zero_rad = table.number("zero_mrad", kMrad, 0.0) * kMilli;
  tolerance.gain = table.number("gain", kShare, 0.0);
  tolerance.quadratic = table.number("quadratic", kShare, 0.0);
  tolerance.cubic = table.number("cubic", kShare, 0.0);
  tolerance.cross_talk = table.number("cross_talk", kShare, 0.0);
  tolerance.focal = table.number("focal", kShare, 0.0);
  tolerance.centre = table.number("centre", kShare, 0.0);
  tolerance.distortion = table.number("distortion", kShare, 0.0);
  tolerance.mount_rad = table.number("mount_mrad", kMrad, 0.0) * kMilli;
  tolerance.mount_m = table.number("mount_m", kLength, 0.0, kMetres);
  table.finish();
  return tolerance;
}

// A table that must be there; an empty stand-in where it is not, so that reading goes on to nothing.
std::optional<TomlTable> needed(TomlTable& root, std::string_view key) {
  if (!root.has(key)) {
    root.table(key);  // known
    root.fault(RCode::kMissingKey, key, "is needed: [" + std::string(key) + "]");
    return std::nullopt;
  }
  return root.table(key);
}

void read_cameras(TomlTable& root, Board& board) {
  for (TomlTable& table : root.tables("camera")) {
    board.cameras.push_back(read_camera(table, board.cameras.empty()));
  }
  if (!root.has("camera")) {
    root.fault(RCode::kMissingKey, "camera", "is needed: two [[camera]], left first");
  } else if (board.cameras.size() != 2) {
    root.fault(RCode::kBadValue, "camera", "must be two, left first, got " + std::to_string(board.cameras.size()));
  } else if (board.cameras[0].name == board.cameras[1].name) {
    root.fault(RCode::kBadValue, "camera", "has '" + board.cameras[0].name + "' twice");
  }
}

void read(TomlTable& root, Board& board, Faults& faults) {
  board.name = root.text("name");
  board.back_end = root.text("back_end");
  if (auto table = needed(root, "projector")) {
    board.projector = read_projector(*table);
  }
  if (auto table = needed(root, "mirror")) {
    board.mirror = read_mirror(*table, faults);
  }
  read_cameras(root, board);
  if (auto table = root.table("tolerance")) {
    board.tolerance = read_tolerance(*table);
  }
  for (const std::string& text_of_fault : root.texts("faults")) {
    Result<Fault> fault = read_fault(text_of_fault);
    if (fault) {
      board.faults.push_back(std::move(*fault));
    } else {
      root.fault(RCode::kBadValue, "faults", fault.error().note);
    }
  }
}

}  // namespace

Result<Board> read_board(std::string_view text, const std::string& file) {
  return document::read_document<Board>(text, file, read);
}

}  // namespace raysteer::proto::board
