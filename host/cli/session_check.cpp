// raysteer session check: is the session what it says it is?
#include <fmt/core.h>

#include "host/cli/commands.hpp"
#include "host/session/check.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

Json to_json(const Error& error) {
  return {{"code", to_string(error.rcode)}, {"message", error.message()}, {"remedy", explain(error.rcode).remedy}};
}

class SessionCheck : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Read every frame of a session and say whether it can be used",
            .description =
                "Finds missing, damaged, repeated or exchanged frames, patterns exchanged with their "
                "inverses, black and saturated frames, and anything that moved between frames.",
            .example = "raysteer session check scan.toml\nraysteer session check scan.toml --frames ~/captures",
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
  }

  Result<ExitCode> run(Context& context) override {
    const Result<session::Session> opened = session::Session::open(session_, context.frames_root());
    RAYSTEER_TRY(opened);
    const Tick tick = context.stage("reading frames");
    bool cancelled = false;
    const session::CheckReport report = session::check_session(*opened, [&](int done, int total) {
      cancelled = !tick(static_cast<double>(done) / total) || cancelled;
      return !cancelled;
    });
    RAYSTEER_TRY(Context::poll());

    Json& json = context.json();
    json["name"] = opened->manifest().name;
    json["frames"] = report.frames;
    json["good"] = report.good();
    json["looks"] = Json::array();
    for (const session::LookCheck& look : report.looks) {
      const calib::decode::SequenceReport& r = look.report;
      json["looks"].push_back({{"camera", look.camera},
                               {"look", look.look},
                               {"lit", r.lit},
                               {"contrast", r.contrast},
                               {"brightest", r.brightest},
                               {"saturated", r.saturated},
                               {"codes_coherent", r.codes_coherent},
                               {"codes_in_panel", r.codes_in_panel},
                               {"phase_residual", r.phase_residual},
                               {"largest_shift_px", r.largest_shift_px}});
      context.print(fmt::format("{:<12} {:<12} lit {:5.1f} %  contrast {:5.1f}  saturated {:5.1f} %  moved {:.2f} px\n",
                                look.camera, look.look, 100 * r.lit, r.contrast, 100 * r.saturated,
                                r.largest_shift_px));
    }
    json["warnings"] = Json::array();
    for (const Error& warning : report.warnings) {
      json["warnings"].push_back(to_json(warning));
      context.note(fmt::format("warning[{}]: {}", to_string(warning.rcode), warning.message()));
    }
    if (!report.good()) {
      // The framework prints the first one; the others stand beside it.
      for (std::size_t i = 1; i < report.faults.size(); ++i) {
        context.note(fmt::format("also[{}]: {}", to_string(report.faults[i].rcode), report.faults[i].message()));
      }
      return report.faults.front();
    }
    context.print(fmt::format("{}: {} frames, good\n", opened->manifest().name, report.frames));
    return ExitCode::kDone;
  }

 private:
  std::string session_;
};

}  // namespace

std::unique_ptr<Command> session_check() { return std::make_unique<SessionCheck>(); }

}  // namespace raysteer::host::cli
