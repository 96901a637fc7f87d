// raysteer session render: sessions of a pretend rig, with the truth beside them.
#include <fmt/core.h>

#include <string>
#include <vector>

#include "calib/synth/stage.hpp"
#include "host/cli/commands.hpp"
#include "host/pretend/rendered_session.hpp"

namespace raysteer::host::cli {
namespace {

using calib::synth::Stage;

class SessionRender : public Command {
 public:
  Manual manual() const override {
    return {
        .summary = "Render sessions of a pretend rig whose truth is known",
        .description =
            "Draws what two cameras would record of a chessboard (cameras), of a chessboard lit by codes (projector), "
            "and of a wall with a box and a ball (scan), with lens distortion, blur and noise. The seed draws rig, "
            "poses and noise: the same seed gives the same bytes. truth.json in each session's folder holds the rig "
            "and the surfaces; calibrate and scan compare their results with it when they find it.",
        .example = "raysteer session render --out demo --seed 1\nraysteer session check demo/scan/session.toml",
        .out = TakesOut::kRequired};
  }

  void declare(Options& options) override {
    options.option("--seed", "N", &seed_, "draws rig, poses and noise; 1 if not given");
    options.option("--kind", "KIND", &kind_, "which sessions").choices({"all", "cameras", "projector", "scan"});
    options.option("--size", "SIZE", &size_, "small: cameras 640x512, panel 640x400; full: twice that")
        .choices({"small", "full"});
  }

  Result<ExitCode> run(Context& context) override {
    const auto seed = static_cast<std::uint64_t>(seed_);
    const calib::synth::PretendRig pretend = calib::synth::pretend_rig(seed, size_ == "full" ? 2 : 1);
    struct Part {
      std::string kind;
      Stage (*stage)(const calib::synth::PretendRig&, std::uint64_t);
    };
    const Part parts[] = {
        {"cameras", [](const auto& rig, std::uint64_t from) { return calib::synth::cameras_stage(rig, from); }},
        {"projector", [](const auto& rig, std::uint64_t from) { return calib::synth::projector_stage(rig, from); }},
        {"scan", [](const auto& rig, std::uint64_t from) { return calib::synth::scan_stage(rig, from); }}};
    Json& json = context.json();
    json["seed"] = seed_;
    for (const auto& [kind, make] : parts) {
      if (kind_ != "all" && kind_ != kind) {
        continue;
      }
      const Stage stage = make(pretend, seed);
      RAYSTEER_TRY(
          pretend::write_session(stage, pretend.rig(), seed, context.out() / kind, context.stage("rendering " + kind)));
      const std::size_t frames =
          stage.looks.size() * stage.cameras.size() * static_cast<std::size_t>(stage.sequence.frames());
      const std::string file = (context.final_out() / kind / "session.toml").string();
      json["sessions"].push_back({{"kind", kind}, {"file", file}, {"looks", stage.looks.size()}, {"frames", frames}});
      context.print(fmt::format("{}: {} looks, {} frames\n", file, stage.looks.size(), frames));
    }
    return ExitCode::kDone;
  }

 private:
  int seed_ = 1;
  std::string kind_ = "all";
  std::string size_ = "small";
};

}  // namespace

std::unique_ptr<Command> session_render() { return std::make_unique<SessionRender>(); }

}  // namespace raysteer::host::cli
