#include "proto/document/toml_text.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::proto::session {

using document::number;
using document::quoted;
namespace {

template <class Value>
std::string array(const std::vector<Value>& values) {
  std::string out = "[";
  for (std::size_t i = 0; i < values.size(); ++i) {
    out += i > 0 ? ", " : "";
    if constexpr (std::is_same_v<Value, std::string>) {
      out += quoted(values[i]);
    } else {
      out += number(values[i]);
    }
  }
  return out + "]";
}

class Writer {
 public:
  void line(std::string_view key, const std::string& value) { text_ += std::string(key) + " = " + value + "\n"; }
  void text(std::string_view key, const std::string& value) {
    if (!value.empty()) {
      line(key, quoted(value));
    }
  }
  template <class Value>
  void maybe(std::string_view key, const std::optional<Value>& value) {
    if (value) {
      line(key, number(*value));
    }
  }
  void maybe(std::string_view key, const std::optional<std::vector<double>>& values) {
    if (values) {
      line(key, array(*values));
    }
  }
  void flag(std::string_view key, bool value) {
    if (value) {
      line(key, "true");
    }
  }
  void differs(std::string_view key, double value, double standard) {
    if (value != standard) {
      line(key, number(value));
    }
  }
  void heading(std::string_view name) { text_ += "\n" + std::string(name) + "\n"; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

void write_block(Writer& out, const PatternBlock& block) {
  const PatternBlock standard;
  const char* axis = block.axis == Axis::kX ? "\"x\"" : "\"y\"";
  out.heading("[[sequence]]");
  switch (block.kind) {
    case PatternKind::kWhite:
      out.line("kind", "\"white\"");
      break;
    case PatternKind::kBlack:
      out.line("kind", "\"black\"");
      break;
    case PatternKind::kGray:
      out.line("kind", "\"gray\"");
      out.line("axis", axis);
      out.line("bits", number(std::int64_t{block.bits}));
      out.differs("stripe_px", block.stripe_px, standard.stripe_px);
      out.differs("offset_px", block.offset_px, standard.offset_px);
      out.flag("inverse", block.inverse);
      out.flag("inverse_first", block.inverse_first);
      out.flag("lsb_first", block.lsb_first);
      break;
    case PatternKind::kPhase:
      out.line("kind", "\"phase\"");
      out.line("axis", axis);
      out.line("steps", number(std::int64_t{block.steps}));
      out.line("period_px", number(block.period_px));
      out.differs("origin_px", block.origin_px, standard.origin_px);
      out.differs("sign", block.sign, standard.sign);
      break;
  }
}

void write_target(Writer& out, const Target& target) {
  const TargetSpec& spec = target.spec;
  const bool charuco = spec.kind == TargetKind::kCharuco;
  out.heading("[[target]]");
  out.line("kind", charuco ? "\"charuco\"" : "\"chessboard\"");
  out.line("columns", number(std::int64_t{spec.columns}));
  out.line("rows", number(std::int64_t{spec.rows}));
  out.differs("square_m", spec.square_m, 0);
  if (charuco) {
    out.differs("marker_m", spec.marker_m, 0);
    out.text("dictionary", spec.dictionary);
    if (spec.layout != CharucoLayout::kAuto) {
      out.line("layout", spec.layout == CharucoLayout::kLegacy ? "\"legacy\"" : "\"current\"");
    }
  }
  if (!target.looks.empty()) {
    out.line("looks", array(target.looks));
  }
}

void write_shot(Writer& out, const Shot& shot) {
  out.heading("[[shot]]");
  out.line("look", quoted(shot.look));
  out.line("index", number(std::int64_t{shot.index}));
  out.maybe("sequence_number", shot.sequence_number);
  out.maybe("rig_time_ns", shot.rig_time_ns);
  out.maybe("trigger_time_ns", shot.trigger_time_ns);
  out.maybe("exposure_us", shot.exposure_us);
  out.maybe("mirror_command_rad", shot.mirror_command);
  out.maybe("mirror_feedback_rad", shot.mirror_feedback);
  if (!shot.camera_times_ns.empty()) {
    out.line("camera_times_ns", array(shot.camera_times_ns));
  }
}

}  // namespace

std::string write_manifest(const Manifest& manifest) {
  Writer out;
  out.line("format", number(std::int64_t{kFormat}));
  out.line("name", quoted(manifest.name));
  out.text("rig", manifest.rig);
  out.text("note", manifest.note);
  out.text("frames", manifest.frames);
  out.maybe("exposure_us", manifest.exposure_us);
  if (manifest.sequence.panel_width > 0) {
    out.heading("[projector]");
    out.line("width", number(std::int64_t{manifest.sequence.panel_width}));
    out.line("height", number(std::int64_t{manifest.sequence.panel_height}));
  }
  for (const Camera& camera : manifest.cameras) {
    out.heading("[[camera]]");
    out.line("name", quoted(camera.name));
    out.line("files", quoted(camera.files));
    out.differs("first_index", camera.first_index, 0);
    out.differs("width", camera.width, 0);
    out.differs("height", camera.height, 0);
    out.line("bits", number(std::int64_t{camera.bits}));
  }
  for (const PatternBlock& block : manifest.sequence.blocks) {
    write_block(out, block);
  }
  for (const Look& look : manifest.looks) {
    out.heading("[[look]]");
    out.line("name", quoted(look.name));
    out.maybe("command_rad", look.command);
    out.text("note", look.note);
  }
  for (const Target& target : manifest.targets) {
    write_target(out, target);
  }
  for (const Shot& shot : manifest.shots) {
    write_shot(out, shot);
  }
  return out.take();
}

}  // namespace raysteer::proto::session
