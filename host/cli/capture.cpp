// raysteer capture: a plan becomes a session. So far from the pretend rig only.
#include <fmt/core.h>

#include <string>
#include <utility>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/pretend.hpp"

namespace raysteer::host::cli {
namespace {

class Capture : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Record a session: patterns shown, both cameras triggered, each pair verified",
            .description =
                "Runs a plan on the pretend rig, whose truth is known: a board says what it is made of, a scene what "
                "it looks at, a seed how it departs from its drawings. Pairs that are late, torn, saturated or do not "
                "show their pattern are taken again; each is said and counted. The projector's latency and the "
                "lamps' flicker are measured first.\n\n"
                "--out DIR gets session.toml, raw frames and truth.json. Without --looks it is one look, straight "
                "ahead. Plans, boards and scenes that are installed go by their names; docs/plan-format.md, "
                "docs/board-format.md and docs/scene-format.md say how to write one.",
            .example =
                "raysteer capture --sim --out scan\n"
                "raysteer capture --sim --looks cameras --scene floor --out cameras\n"
                "raysteer capture --sim --board mock-head --patterns fast --fault left.drop*3 --out faulty",
            .out = TakesOut::kRequired};
  }

  void declare(Options& options) override {
    options.flag("--sim", sim_, "from the pretend rig; there is no other yet");
    options.option("--patterns", "SET", &patterns_, "what is projected, if the plan does not say")
        .choices({"default", "fast", "best", "gray"});
    options.option("--looks", "FILE", &looks_, "plan file, or an installed one's name");
    declare_pretend(options, pretend_);
    options.flag("--paced", paced_, "not faster than the wall clock, for people who watch");
  }

  Result<ExitCode> run(Context& context) override {
    if (!sim_) {
      return fail(RCode::kUsage, "raysteer capture: give --sim; rigs other than the pretend one are not supported yet");
    }
    std::vector<std::string> words = pretend_.arguments();
    words.insert(words.begin(), "capture");
    words.insert(words.end(), {"--patterns", patterns_, "--out", context.out().string()});
    if (!looks_.empty()) {
      words.insert(words.end(), {"--looks", looks_});
    }
    if (paced_) {
      words.emplace_back("--paced");
    }
    Result<sim::Json> captured = sim::run(std::move(words), listen(context));
    if (!captured) {
      return std::move(captured).error();
    }
    Json& json = context.json();
    json["session"] = (context.final_out() / "session.toml").string();
    json.update(*captured);
    print(context);
    return ExitCode::kDone;
  }

 private:
  static void print(Context& context) {
    const Json& json = context.json();
    context.print(fmt::format("{}: {} look(s), {} shots, {} taken again\n", json.value("session", ""),
                              json.value("looks", 0), json.value("shots", 0), json.value("retaken", 0)));
    const Json none = Json::object();
    for (const auto& [code, count] : (json.contains("retakes") ? json["retakes"] : none).items()) {
      context.print(fmt::format("  {} times {}\n", count.get<int>(), code));
    }
    context.print(fmt::format("exposure {} us; ", json.value("exposure_us", 0)));
    if (json.contains("latency_us") && !json["latency_us"].is_null()) {
      context.print(fmt::format("projector latency {} us; ", json.value("latency_us", 0)));
    }
    if (json.contains("flicker_hz") && !json["flicker_hz"].is_null()) {
      context.print(fmt::format("lamps flicker at {:.0f} Hz; ", json.value("flicker_hz", 0.0)));
    }
    context.print(fmt::format("{:.2f} s of the rig's time\n", json.value("rig_s", 0.0)));
  }

  bool sim_ = false;
  bool paced_ = false;
  std::string patterns_ = "default";
  std::string looks_;
  sim::PretendOptions pretend_;
};

}  // namespace

std::unique_ptr<Command> capture() { return std::make_unique<Capture>(); }

}  // namespace raysteer::host::cli
