#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "proto/document/parse.hpp"
#include "proto/document/paths.hpp"
#include "proto/document/pattern_table.hpp"
#include "proto/document/target_table.hpp"
#include "proto/document/toml_table.hpp"
#include "proto/session/file_name.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::proto::session {

using document::Faults;
using document::place;
using document::Range;
using document::TomlTable;
namespace {

// Bounds that only nonsense exceeds; they keep memory and time small whatever the file says.
constexpr std::int64_t kLargestSide = 65535;
constexpr std::size_t kMostLooks = 100'000;
constexpr std::size_t kMostBlocks = 256;
constexpr std::int64_t kLargestIndex = 1'000'000'000;
constexpr std::size_t kDeepestInclude = 16;
constexpr Range<std::int64_t> kSide{1, kLargestSide};
constexpr Range<std::int64_t> kAnyInteger{std::numeric_limits<std::int64_t>::min(),
                                          std::numeric_limits<std::int64_t>::max()};
constexpr Range<std::int64_t> kNotNegative{0, std::numeric_limits<std::int64_t>::max()};

// A file and, behind it, what it includes: the order in which keys are looked for.
struct Layers {
  std::vector<toml::table> tables;
  std::vector<std::string> open;  // files being read, outermost first
};

std::string folder_of(const std::string& file) {
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos ? "" : file.substr(0, slash + 1);
}

// Without "." and empty parts, so that one file has one name.
std::string tidy_path(std::string_view path) {
  std::string tidy;
  for (std::size_t begin = 0; begin < path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    const std::string_view part = path.substr(begin, end - begin);
    if (!part.empty() && part != ".") {
      tidy += (tidy.empty() ? "" : "/") + std::string(part);
    }
    begin = end + 1;
  }
  return tidy;
}

// `shown` is the name in messages, `path` the one relative to the session's folder.
Status read_layers(std::string_view text, const std::string& shown, const std::string& path, const Loader& load,
                   Layers& layers) {
  Result<toml::table> parsed = document::parse(text, shown);
  if (!parsed) {
    return std::move(parsed).error();
  }
  toml::table table = std::move(*parsed);

  Faults faults;
  TomlTable root({&table}, "", faults);
  const std::vector<std::string> includes = root.texts("include");
  std::string include_line = shown + ":1";
  if (const toml::node* node = table.get("include")) {
    include_line = place(*node);
  }
  RAYSTEER_TRY(faults.status());

  layers.tables.push_back(std::move(table));
  layers.open.push_back(path);
  for (const std::string& include : includes) {
    if (const auto why = document::leaves_folder(include)) {
      return fail(RCode::kPathOutside, include_line + ": include '" + include + "' " + *why);
    }
    const std::string included = tidy_path(folder_of(path) + include);
    if (std::ranges::find(layers.open, included) != layers.open.end()) {
      std::string circle;
      for (const std::string& file : layers.open) {
        circle += file + " -> ";
      }
      return fail(RCode::kCircularInclude, include_line + ": " + circle + included);
    }
    // Diamonds double the work at each level; real sessions include one or two files.
    if (layers.open.size() > kDeepestInclude || layers.tables.size() > kDeepestInclude) {
      return fail(RCode::kBadValue, include_line + ": more than " + std::to_string(kDeepestInclude) + " includes");
    }
    Result<std::string> included_text = load(included);
    if (!included_text) {
      return with_context(std::move(included_text).error(), include_line + ": include '" + include + "'");
    }
    RAYSTEER_TRY(read_layers(*included_text, included, included, load, layers));
  }
  layers.open.pop_back();
  return ok();
}

int to_int(std::int64_t value) { return static_cast<int>(value); }

// Names become parts of file names.
std::string read_name(TomlTable& table, std::string_view key, const std::string& value) {
  if (value.empty() || value == "." || value == ".." || value.find('/') != std::string::npos ||
      document::leaves_folder(value)) {
    table.fault(RCode::kBadValue, key, "is '" + value + "', which cannot be part of a file name");
  }
  return value;
}

PatternSequence read_sequence(TomlTable& root, const std::string& file, Faults& faults) {
  PatternSequence sequence;
  if (auto projector = root.table("projector")) {
    sequence.panel_width = to_int(projector->integer("width", kSide));
    sequence.panel_height = to_int(projector->integer("height", kSide));
    projector->finish();
  }
  for (TomlTable& table : root.tables("sequence")) {
    if (sequence.blocks.size() == kMostBlocks) {
      root.fault(RCode::kBadValue, "sequence", "has more than " + std::to_string(kMostBlocks) + " blocks");
      break;
    }
    sequence.blocks.push_back(document::read_pattern_block(table, sequence.panel_width, sequence.panel_height, faults));
  }
  if (sequence.blocks.empty()) {
    sequence.blocks.push_back({.kind = PatternKind::kWhite});
  }
  const bool coded = std::ranges::any_of(sequence.blocks, [](const PatternBlock& block) {
    return block.kind == PatternKind::kGray || block.kind == PatternKind::kPhase;
  });
  if (coded && sequence.panel_width == 0) {
    root.fault(RCode::kMissingKey, "projector", "with width and height is needed by a coded sequence");
  } else if (coded) {
    if (Status status = check(sequence); !status) {
      faults.add(with_context(std::move(status).error(), file + ": [[sequence]]"));
    }
  }
  return sequence;
}

Camera read_camera(TomlTable& table) {
  Camera camera;
  camera.name = read_name(table, "name", table.text("name"));
  camera.files = table.text("files");
  camera.first_index = to_int(table.integer("first_index", {0, kLargestIndex}, 0));
  camera.width = to_int(table.integer("width", kSide, 0));
  camera.height = to_int(table.integer("height", kSide, 0));
  if ((camera.width == 0) != (camera.height == 0)) {
    table.fault(RCode::kMissingKey, camera.width == 0 ? "width" : "height", "is needed beside the other side");
  }
  camera.bits = to_int(table.integer("bits", {8, 16}, 8));
  if (camera.bits != 8 && camera.bits != 16) {
    table.fault(RCode::kBadValue, "bits", "must be 8 or 16, got " + std::to_string(camera.bits));
    camera.bits = 8;
  }
  if (const auto why = document::leaves_folder(camera.files)) {
    table.fault(RCode::kPathOutside, "files", "is '" + camera.files + "', which " + *why);
  }
  table.finish();
  return camera;
}

// Would two frames have the same file?
void check_templates(TomlTable& root, const Manifest& manifest) {
  std::set<std::string> templates;
  for (const Camera& camera : manifest.cameras) {
    const std::string where = "'" + camera.name + "': files = \"" + camera.files + "\" ";
    const Result<TemplateUse> use = check_template(camera.files);
    if (!use) {
      root.fault(RCode::kBadValue, "camera", where + use.error().note);
      return;
    }
    if (!use->index && manifest.sequence.frames() > 1) {
      root.fault(
          RCode::kBadValue, "camera",
          where + "lacks {index}: all " + std::to_string(manifest.sequence.frames()) + " frames would be one file");
    }
    if (!use->look && manifest.looks.size() > 1) {
      root.fault(RCode::kBadValue, "camera",
                 where + "lacks {look}: all " + std::to_string(manifest.looks.size()) + " looks would be one file");
    }
    if (!templates.insert(use->camera ? camera.files + camera.name : camera.files).second) {
      root.fault(RCode::kBadValue, "camera", where + "is also that of another camera; use {camera}");
    }
  }
}

std::vector<Look> read_looks(TomlTable& root) {
  std::vector<Look> looks;
  std::set<std::string> names;
  const auto add = [&](Look look) {
    if (!names.insert(look.name).second) {
      root.fault(RCode::kBadValue, root.has("looks") ? "looks" : "look", "has '" + look.name + "' twice");
    }
    looks.push_back(std::move(look));
  };
  const std::vector<std::string> shorthand = root.texts("looks");
  std::vector<TomlTable> tables = root.tables("look");
  if (!shorthand.empty() && !tables.empty()) {
    root.fault(RCode::kBadValue, "looks", "and [[look]] say the same; give one of them");
  }
  if (shorthand.size() > kMostLooks || tables.size() > kMostLooks) {
    root.fault(RCode::kBadValue, "looks", "are more than " + std::to_string(kMostLooks));
    return looks;
  }
  for (const std::string& name : shorthand) {
    add({.name = read_name(root, "looks", name)});
  }
  for (TomlTable& table : tables) {
    Look look{.name = read_name(table, "name", table.text("name"))};
    if (table.has("command_rad")) {
      look.command = table.numbers("command_rad");
    }
    table.numbers("command_rad");  // known, there or not
    look.note = table.text("note", "");
    table.finish();
    add(std::move(look));
  }
  if (looks.empty()) {
    looks.push_back({.name = "scene"});
  }
  return looks;
}

Target read_target(TomlTable& table, const std::vector<Look>& looks) {
  Target target{.spec = document::read_target_spec(table), .looks = {}};
  target.looks = table.texts("looks");
  for (const std::string& name : target.looks) {
    if (std::ranges::find(looks, name, &Look::name) == looks.end()) {
      table.fault(RCode::kBadValue, "looks", "has '" + name + "', which is no look of this session");
    }
  }
  table.finish();
  return target;
}

std::optional<std::vector<double>> maybe_numbers(TomlTable& table, std::string_view key) {
  std::vector<double> values = table.numbers(key);
  return values.empty() ? std::nullopt : std::optional(std::move(values));
}

Shot read_shot(TomlTable& table, const Manifest& manifest, const std::set<std::string>& looks) {
  Shot shot;
  shot.look = table.text("look", manifest.looks.size() == 1 ? std::optional(manifest.looks[0].name) : std::nullopt);
  if (!shot.look.empty() && !looks.contains(shot.look)) {
    table.fault(RCode::kBadValue, "look", "is '" + shot.look + "', which is no look of this session");
  }
  shot.index = to_int(table.integer("index", {0, std::max(manifest.sequence.frames() - 1, 0)}));
  shot.sequence_number = table.maybe_integer("sequence_number", kNotNegative);
  shot.rig_time_ns = table.maybe_integer("rig_time_ns", kAnyInteger);
  shot.trigger_time_ns = table.maybe_integer("trigger_time_ns", kAnyInteger);
  shot.exposure_us = table.maybe_integer("exposure_us", kNotNegative);
  shot.mirror_command = maybe_numbers(table, "mirror_command_rad");
  shot.mirror_feedback = maybe_numbers(table, "mirror_feedback_rad");
  shot.camera_times_ns = table.integers("camera_times_ns");
  table.finish();
  return shot;
}

}  // namespace

Result<Manifest> read_manifest(std::string_view text, const std::string& file, const Loader& load) {
  Layers layers;
  const std::string base = file.substr(file.rfind('/') + 1);  // npos + 1 is 0: all of it
  RAYSTEER_TRY(read_layers(text, file, base, load, layers));

  std::vector<const toml::table*> tables;
  for (const toml::table& table : layers.tables) {
    tables.push_back(&table);
  }
  Faults faults;
  TomlTable root(tables, "", faults);
  root.integer("format", kAnyInteger);
  root.texts("include");

  Manifest manifest;
  manifest.name = root.text("name");
  manifest.rig = root.text("rig", "");
  manifest.note = root.text("note", "");
  manifest.frames = tidy_path(root.text("frames", ""));
  if (const auto why = document::leaves_folder(root.text("frames", ""))) {
    root.fault(RCode::kPathOutside, "frames", "is '" + root.text("frames", "") + "', which " + *why);
  }
  if (root.has("exposure_us")) {
    manifest.exposure_us = root.number("exposure_us", {0, 1e9});
  }
  root.number("exposure_us", {0, 1e9}, 0.0);  // known, there or not
  manifest.sequence = read_sequence(root, file, faults);
  for (TomlTable& table : root.tables("camera")) {
    manifest.cameras.push_back(read_camera(table));
  }
  if (!root.has("camera")) {
    root.fault(RCode::kMissingKey, "camera", "is needed: one [[camera]] or two");
  } else if (manifest.cameras.size() > 2) {
    root.fault(RCode::kBadValue, "camera", "must be one or two, got " + std::to_string(manifest.cameras.size()));
  } else if (manifest.cameras.size() == 2 && manifest.cameras[0].name == manifest.cameras[1].name) {
    root.fault(RCode::kBadValue, "camera", "has '" + manifest.cameras[0].name + "' twice");
  }
  manifest.looks = read_looks(root);
  check_templates(root, manifest);
  for (TomlTable& table : root.tables("target")) {
    manifest.targets.push_back(read_target(table, manifest.looks));
  }
  std::set<std::string> looks;
  for (const Look& look : manifest.looks) {
    looks.insert(look.name);
  }
  for (TomlTable& table : root.tables("shot")) {
    manifest.shots.push_back(read_shot(table, manifest, looks));
  }
  root.finish();
  RAYSTEER_TRY(faults.status());
  return manifest;
}

const TargetSpec* Manifest::target_of(std::string_view look) const {
  for (const Target& target : targets) {
    if (target.looks.empty() || std::ranges::find(target.looks, look) != target.looks.end()) {
      return &target.spec;
    }
  }
  return nullptr;
}

}  // namespace raysteer::proto::session
