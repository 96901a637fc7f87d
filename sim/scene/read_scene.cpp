#include "sim/scene/read_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <utility>

#include "proto/document/parse.hpp"
#include "proto/document/target_table.hpp"
#include "proto/document/toml_table.hpp"
#include "sim/scene/read_picture.hpp"

namespace raysteer::sim::scene {

using proto::document::Faults;
using proto::document::Range;
using proto::document::TomlTable;
namespace {

namespace fs = std::filesystem;

constexpr double kDegree = std::numbers::pi / 180;
constexpr Range<double> kShare{0, 1};
constexpr Range<double> kTime{0, 1e6};
constexpr Range<double> kLength{1e-4, 1000};
constexpr std::string_view kMetres = "lengths are in metres (25 mm is 0.025)";

Result<std::string> bytes_of(const fs::path& path, RCode missing) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) {
    return fail(missing, path.string());
  }
  std::ifstream stream(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << stream.rdbuf();
  if (!stream || !bytes) {
    return fail(RCode::kFileUnreadable, path.string());
  }
  return std::move(bytes).str();
}

// A file that the scene names, which must lie in the scene's folder or below.
std::optional<std::string> bytes_beside(TomlTable& table, std::string_view key, const std::string& name,
                                        const fs::path& scene, RCode missing, Faults& faults) {
  if (name.empty()) {
    return {};  // said already
  }
  const fs::path relative = fs::path(name).lexically_normal();
  if (relative.is_absolute() || *relative.begin() == "..") {
    table.fault(RCode::kPathOutside, key, "is '" + name + "'; expected a file beside the scene");
    return {};
  }
  auto bytes = bytes_of(scene.parent_path() / relative, missing);
  if (!bytes) {
    faults.add(std::move(bytes).error());
    return {};
  }
  return std::move(*bytes);
}

std::optional<Eigen::Vector3d> three(TomlTable& table, std::string_view key, double most, std::string_view hint) {
  const bool there = table.has(key);
  const std::vector<double> numbers = table.numbers(key);
  if (!there || numbers.empty()) {
    return {};  // an empty or wrong one has been said
  }
  const Eigen::Vector3d v = numbers.size() == 3 ? Eigen::Vector3d(numbers[0], numbers[1], numbers[2])
                                                : Eigen::Vector3d::Constant(std::nan(""));
  if (!(v.cwiseAbs().maxCoeff() <= most) || !v.allFinite()) {
    table.fault(RCode::kBadValue, key,
                "must be three numbers up to " + std::to_string(std::lround(most)) + "; " + std::string(hint));
    return {};
  }
  return v;
}

Eigen::Matrix3d turned(const Eigen::Vector3d& rotation_deg) {
  const double angle = rotation_deg.norm();
  return angle == 0 ? Eigen::Matrix3d::Identity()
                    : Eigen::AngleAxisd(angle * kDegree, rotation_deg / angle).toRotationMatrix();
}

Eigen::Isometry3d read_pose(TomlTable& table) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() = three(table, "position_m", 1000, kMetres).value_or(Eigen::Vector3d::Zero());
  T.linear() =
      turned(three(table, "rotation_deg", 180, "a rotation vector in degrees").value_or(Eigen::Vector3d::Zero()));
  return T;
}

class SceneReader {
 public:
  SceneReader(const fs::path& file, Faults& faults) : file_(file), faults_(faults) {}

  Scene read(TomlTable& root) {
    root.integer("format", {1, 1});
    root.text("include", "");  // known
    scene_.name = root.text("name");
    read_ambient(root);
    read_rig(root);
    for (TomlTable& table : root.tables("plane")) {
      const auto [width, height] = sides(table);
      add(table, rectangle(-width / 2, -height / 2, width / 2, height / 2));
    }
    for (TomlTable& table : root.tables("box")) {
      const Eigen::Vector3d size = three(table, "size_m", 1000, kMetres).value_or(Eigen::Vector3d::Zero());
      if (!(size.minCoeff() > 0)) {
        table.fault(RCode::kBadValue, "size_m", "must be three lengths above 0: along x, y and z");
      }
      add(table, box(size));
    }
    for (TomlTable& table : root.tables("stairs")) {
      const int count = static_cast<int>(table.integer("count", {1, 1000}));
      const double depth = table.number("depth_m", kLength, {}, kMetres);
      const double width = table.number("width_m", kLength, {}, kMetres);
      add(table, stairs(count, depth, width, table.number("height_m", kLength, {}, kMetres)));
    }
    for (TomlTable& table : root.tables("door")) {
      const double length = table.number("length_m", kLength, {}, kMetres);
      const double width = table.number("width_m", kLength, {}, kMetres);
      const double crown = table.number("crown_m", {0, 10}, {}, kMetres);
      const double cell = table.number("cell_m", kLength, 0.01, kMetres);
      constexpr double kMostCells = 1e6;
      if (length * width / (cell * cell) > kMostCells) {
        table.fault(RCode::kBadValue, "cell_m", "makes more than a million cells");
        continue;
      }
      add(table, door(length, width, crown, cell));
    }
    for (TomlTable& table : root.tables("person")) {
      add(table, person(table.number("height_m", {0.1, 3}, 1.75, kMetres)));
    }
    for (TomlTable& table : root.tables("mesh")) {
      read_mesh(table);
    }
    for (TomlTable& table : root.tables("target")) {
      read_target(table);
    }
    for (TomlTable& table : root.tables("datum")) {
      read_datum(table);
    }
    if (scene_.surfaces.empty()) {
      root.fault(RCode::kMissingKey, "plane", "is needed: a scene has a surface at least");
    }
    root.finish();
    return std::move(scene_);
  }

 private:
  void read_ambient(TomlTable& root) {
    if (auto table = root.table("ambient")) {
      scene_.ambient.lux = table->number("lux", {0, 2e5});
      scene_.ambient.flicker_hz = table->number("flicker_hz", {0, 1e5}, 0.0);
      scene_.ambient.flicker_depth = table->number("flicker_depth", kShare, 0.0, "a share of lux");
      table->finish();
    }
  }

  // The rig looks straight down, with its x along the room's, before it is turned about its own axes.
  void read_rig(TomlTable& root) {
    Eigen::Isometry3d T_room_rig = Eigen::Isometry3d::Identity();
    T_room_rig.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    T_room_rig.translation() = Eigen::Vector3d(0, 0, 3.5);
    if (auto table = root.table("rig")) {
      if (const auto position = three(*table, "position_m", 1000, kMetres)) {
        T_room_rig.translation() = *position;
      } else if (!table->has("position_m")) {
        table->fault(RCode::kMissingKey, "position_m", "is needed: where the left camera is");
      }
      if (const auto rotation = three(*table, "rotation_deg", 180, "a rotation vector in degrees")) {
        T_room_rig.linear() = T_room_rig.linear() * turned(*rotation);
      }
      table->finish();
    }
    scene_.T_room_rig = T_room_rig;
  }

  std::pair<double, double> sides(TomlTable& table) {
    const std::vector<double> size = table.numbers("size_m");
    if (size.size() != 2 || !(size[0] > 0) || !(size[1] > 0)) {
      table.fault(table.has("size_m") ? RCode::kBadValue : RCode::kMissingKey, "size_m",
                  "must be two lengths above 0, in metres");
      return {1, 1};
    }
    return {size[0], size[1]};
  }

  // What every surface has; finishes the table.
  Surface& add(TomlTable& table, Mesh mesh, std::optional<Texture> texture = {}) {
    Surface surface;
    surface.mesh = std::move(mesh);
    surface.name = table.text("name", "");
    surface.T_room_surface = read_pose(table);
    Material& material = surface.material;
    material.albedo = table.number("albedo", kShare, material.albedo, "a share of the light");
    material.gloss = table.number("gloss", kShare, material.gloss, "a share of the light");
    material.gloss_rad = table.number("gloss_mrad", {1, 1000}, material.gloss_rad * 1e3) * 1e-3;
    if (material.albedo + material.gloss > 1) {
      table.fault(RCode::kBadValue, "gloss", "and 'albedo' together must not exceed 1: that would make light");
    }
    material.texture = texture ? std::move(texture) : read_texture(table, surface.mesh);
    surface.appears_s = table.number("appears_s", kTime, surface.appears_s);
    surface.vanishes_s = table.number("vanishes_s", kTime, surface.vanishes_s);
    if (!(surface.appears_s < surface.vanishes_s)) {
      table.fault(RCode::kBadValue, "vanishes_s", "must be later than 'appears_s'");
    }
    read_path(table, surface);
    table.finish();
    return scene_.surfaces.emplace_back(std::move(surface));
  }

  std::optional<Texture> read_texture(TomlTable& parent, const Mesh& mesh) {
    auto table = parent.table("texture");
    if (!table) {
      return {};
    }
    Picture picture;
    const std::string name = table->text("file");
    picture.pixel_m = table->number("pixel_m", {1e-6, 1000}, {}, kMetres);
    table->finish();
    if (mesh.uv.empty()) {
      parent.fault(RCode::kBadValue, "texture",
                   "needs a surface that says how a picture lies on it: a plane, a door, or "
                   "a mesh with texture points");
      return {};
    }
    const auto bytes = bytes_beside(*table, "file", name, file_, RCode::kTextureMissing, faults_);
    if (!bytes) {
      return {};
    }
    auto albedo = read_picture(*bytes, name);
    if (!albedo) {
      faults_.add(std::move(albedo).error());
      return {};
    }
    picture.albedo = std::make_shared<const Image<float>>(std::move(*albedo));
    return Texture(picture);
  }

  void read_path(TomlTable& table, Surface& surface) {
    const std::vector<std::vector<double>> rows = table.matrix("path");
    surface.path_repeats = table.flag("path_repeats", false);
    for (const std::vector<double>& row : rows) {
      if (row.size() != 4 || (!surface.path.empty() && !(row[0] > surface.path.back().time_s))) {
        table.fault(RCode::kBadValue, "path", "must be rows [seconds, x, y, z] with rising seconds; places in metres");
        return;
      }
      surface.path.push_back({.time_s = row[0], .position = {row[1], row[2], row[3]}});
    }
  }

  void read_mesh(TomlTable& table) {
    const std::string name = table.text("file");
    const double scale = table.number("scale", {1e-6, 1e6}, 1.0, "metres per unit of the file");
    const auto bytes = bytes_beside(table, "file", name, file_, RCode::kMeshMissing, faults_);
    if (!bytes) {
      return;
    }
    const bool is_ply = name.ends_with(".ply");
    if (!is_ply && !name.ends_with(".obj")) {
      table.fault(RCode::kBadValue, "file", "must end in .obj or .ply, got '" + name + "'");
      return;
    }
    auto mesh = is_ply ? read_ply(*bytes, name) : read_obj(*bytes, name);
    if (!mesh) {
      faults_.add(std::move(mesh).error());
      return;
    }
    for (Eigen::Vector3d& vertex : mesh->vertices) {
      vertex *= scale;
    }
    constexpr double kFarthest = 1000;  // metres: as far as any place in a scene
    if (std::ranges::any_of(mesh->vertices,
                            [](const Eigen::Vector3d& p) { return !(p.cwiseAbs().maxCoeff() < kFarthest); })) {
      faults_.add(fail(RCode::kMeshNotFinite, name + " is more than a kilometre wide; expected metres, or 'scale'"));
      return;
    }
    add(table, std::move(*mesh));
  }

  Ink read_ink(TomlTable& table) {
    Ink ink;
    ink.white = table.number("white", kShare, ink.white, "albedo of the paper");
    ink.black = table.number("black", kShare, ink.black, "albedo of the ink");
    return ink;
  }

  void read_target(TomlTable& table) {
    PlacedTarget target{.spec = proto::document::read_target_spec(table), .surface = scene_.surfaces.size()};
    const TargetSpec& spec = target.spec;
    if (spec.kind != TargetKind::kChessboard) {
      table.fault(RCode::kBadValue, "kind", "must be 'chessboard' here; other targets are planes with a picture");
      return;
    }
    if (!(spec.square_m > 0)) {
      table.fault(RCode::kMissingKey, "square_m", "is needed: it is drawn at its true size");
      return;
    }
    const double margin = table.number("margin_m", {0, 1}, spec.square_m / 2, kMetres);
    const double edge = spec.square_m + margin;
    const Chessboard print{
        .columns = spec.columns, .rows = spec.rows, .square_m = spec.square_m, .ink = read_ink(table)};
    const std::vector<std::vector<double>> poses = table.matrix("poses");
    const bool rests = table.has("position_m");
    std::vector<Eigen::Isometry3d> T_room_poses;
    for (const std::vector<double>& row : poses) {
      if (row.size() != 6) {
        table.fault(
            RCode::kBadValue, "poses",
            "must be rows of six: the middle's x, y, z in metres and a rotation vector in degrees, in the rig's frame");
        break;
      }
      T_room_poses.push_back(scene_.T_room_rig * held(spec, row));
    }
    Surface& surface =
        add(table,
            rectangle(-edge, -edge, (spec.columns - 1) * spec.square_m + edge, (spec.rows - 1) * spec.square_m + edge),
            Texture(print));
    surface.is_target = true;
    surface.rests = rests;
    surface.T_room_poses = std::move(T_room_poses);
    scene_.targets.push_back(std::move(target));
  }

  // A target as a person holds it: turned about the middle of its corners.
  static Eigen::Isometry3d held(const TargetSpec& spec, const std::vector<double>& row) {
    Eigen::Isometry3d T_rig_target = Eigen::Isometry3d::Identity();
    T_rig_target.linear() = turned({row[3], row[4], row[5]});
    const Eigen::Vector3d middle(spec.square_m * (spec.columns - 1) / 2, spec.square_m * (spec.rows - 1) / 2, 0);
    T_rig_target.translation() = Eigen::Vector3d(row[0], row[1], row[2]) - T_rig_target.linear() * middle;
    return T_rig_target;
  }

  void read_datum(TomlTable& table) {
    RingDatum datum;
    datum.radius_m = table.number("radius_m", {1e-4, 1}, datum.radius_m, kMetres);
    datum.bits = static_cast<int>(table.integer("bits", {4, 31}, datum.bits));
    datum.code = static_cast<unsigned>(table.integer("code", {0, (std::int64_t{1} << datum.bits) - 1}));
    datum.ink = read_ink(table);
    const double half = 3.5 * datum.radius_m;
    add(table, rectangle(-half, -half, half, half), Texture(datum));
  }

  fs::path file_;
  Faults& faults_;
  Scene scene_;
};

}  // namespace

Result<Scene> read_scene(std::string_view text, const fs::path& file) {
  Result<toml::table> own = proto::document::parse(text, file.string());
  if (!own) {
    return std::move(own).error();
  }
  Faults faults;
  toml::table shared;
  std::vector<const toml::table*> layers{&*own};
  if (own->contains("include")) {
    TomlTable including({&*own}, "", faults);
    const std::string name = including.text("include");
    const auto included = bytes_beside(including, "include", name, file, RCode::kFileMissing, faults);
    RAYSTEER_TRY(faults.status());
    Result<toml::table> parsed = proto::document::parse(included.value_or(""), name);
    if (!parsed) {
      return std::move(parsed).error();
    }
    shared = std::move(*parsed);
    layers.push_back(&shared);
  }
  TomlTable root(layers, "", faults);
  Scene scene = SceneReader(file, faults).read(root);
  RAYSTEER_TRY(faults.status());
  return scene;
}

Result<Scene> load_scene(const fs::path& file) {
  auto text = bytes_of(file, RCode::kFileMissing);
  RAYSTEER_TRY(text);
  return read_scene(*text, file);
}

}  // namespace raysteer::sim::scene
