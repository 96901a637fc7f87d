// raysteer session info: what a session holds, without reading its pixels.
#include <fmt/core.h>

#include "host/cli/commands.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

std::string words(const PatternBlock& block) {
  const char axis = block.axis == Axis::kX ? 'x' : 'y';
  switch (block.kind) {
    case PatternKind::kWhite:
      return "white";
    case PatternKind::kBlack:
      return "black";
    case PatternKind::kGray:
      return fmt::format("Gray code along {}, {} bits{}", axis, block.bits, block.inverse ? " with inverse" : "");
    case PatternKind::kPhase:
      return fmt::format("{} steps along {}, period {} px", block.steps, axis, block.period_px);
  }
  return "";
}

class SessionInfo : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Say what a session holds",
            .description = "Cameras, patterns, looks and targets, without reading the frames' pixels.",
            .example = "raysteer session info scan.toml\nraysteer session info scan.toml --json",
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
  }

  Result<ExitCode> run(Context& context) override {
    const Result<session::Session> opened = session::Session::open(session_, context.frames_root());
    RAYSTEER_TRY(opened);
    const proto::session::Manifest& manifest = opened->manifest();
    Json& json = context.json();
    json["name"] = manifest.name;
    json["rig"] = manifest.rig;
    json["frames_folder"] = opened->frames_folder().string();
    json["frames_per_look"] = opened->frames_per_look();
    json["projector"] = {{"width", manifest.sequence.panel_width}, {"height", manifest.sequence.panel_height}};
    json["cameras"] = Json::array();
    json["sequence"] = Json::array();
    json["looks"] = Json::array();
    json["targets"] = Json::array();
    context.print(fmt::format("{}\nframes in {}\n", manifest.name, opened->frames_folder().string()));
    for (int camera = 0; camera < opened->cameras(); ++camera) {
      const std::string& name = manifest.cameras[static_cast<std::size_t>(camera)].name;
      json["cameras"].push_back({{"name", name},
                                 {"width", opened->width(camera)},
                                 {"height", opened->height(camera)},
                                 {"bits", opened->bits(camera)}});
      context.print(fmt::format("camera    {}: {} x {} px, {} bits\n", name, opened->width(camera),
                                opened->height(camera), opened->bits(camera)));
    }
    if (manifest.sequence.panel_width > 0) {
      context.print(
          fmt::format("projector {} x {} px\n", manifest.sequence.panel_width, manifest.sequence.panel_height));
    }
    for (const PatternBlock& block : manifest.sequence.blocks) {
      json["sequence"].push_back({{"pattern", words(block)}, {"frames", block.frames()}});
      context.print(fmt::format("sequence  {:>3} frames: {}\n", block.frames(), words(block)));
    }
    for (const proto::session::Look& look : manifest.looks) {
      json["looks"].push_back(look.name);
    }
    context.print(fmt::format("looks     {} of {} frames each\n", manifest.looks.size(), opened->frames_per_look()));
    for (const proto::session::Target& target : manifest.targets) {
      const TargetSpec& spec = target.spec;
      const char* kind = spec.kind == TargetKind::kCharuco ? "charuco" : "chessboard";
      json["targets"].push_back(
          {{"kind", kind}, {"columns", spec.columns}, {"rows", spec.rows}, {"square_m", spec.square_m}});
      context.print(fmt::format("target    {} {} x {}, squares of {} m\n", kind, spec.columns, spec.rows,
                                spec.square_m > 0 ? fmt::format("{}", spec.square_m) : std::string("unknown")));
    }
    return ExitCode::kDone;
  }

 private:
  std::string session_;
};

}  // namespace

std::unique_ptr<Command> session_info() { return std::make_unique<SessionInfo>(); }

}  // namespace raysteer::host::cli
