// raysteer sim: the pretend rig itself, seen by a person in its room.
#include <fmt/core.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/pretend.hpp"

namespace raysteer::host::cli {
namespace {

class Sim : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Look at the pretend rig: a picture of its room, and what can go wrong",
            .description =
                "The pretend rig behaves like a real one, down to lag, noise, distortion and faults, in a room whose "
                "light is traced. --picture FILE saves what a person in the room sees, at the mirror position --look "
                "and with --content on the projector (white if not given). --faults lists the faults that --fault "
                "knows. 'raysteer capture --sim' records sessions with it.",
            .example =
                "raysteer sim --faults\n"
                "raysteer sim --scene factory --picture room.png\n"
                "raysteer sim --board mock-head --look 20,-10 --content drawing.png --picture room.png"};
  }

  void declare(Options& options) override {
    options.option("--picture", "FILE", &picture_, "save what a person in the room sees, as PNG");
    options.option("--look", "MRAD,MRAD", &look_, "where the mirror stands: two mechanical angles; 0,0 if not given");
    options.option("--content", "FILE", &content_, "grey PNG of the panel's size to project; white if not given");
    options.flag("--faults", faults_, "list the faults that can be asked for");
    declare_pretend(options, pretend_);
  }

  Result<ExitCode> run(Context& context) override {
    if (faults_ != picture_.empty()) {
      return fail(RCode::kUsage, "raysteer sim: give one of --picture FILE, --faults");
    }
    return faults_ ? list_faults(context) : take_picture(context);
  }

 private:
  static Result<ExitCode> list_faults(Context& context) {
    Result<sim::Json> listed = sim::run({"faults"}, listen(context));
    if (!listed) {
      return std::move(listed).error();
    }
    context.json() = *std::move(listed);
    for (const Json& word : context.json()["faults"]) {
      context.print(fmt::format("{:<28} {}\n", word.value("fault", ""), word.value("meaning", "")));
    }
    return ExitCode::kDone;
  }

  Result<ExitCode> take_picture(Context& context) const {
    std::vector<std::string> words = pretend_.arguments();
    words.insert(words.begin(), "picture");
    words.insert(words.end(), {"--picture", picture_, "--look=" + look_});
    if (!content_.empty()) {
      words.insert(words.end(), {"--content", content_});
    }
    Result<sim::Json> taken = sim::run(std::move(words), listen(context));
    if (!taken) {
      return std::move(taken).error();
    }
    context.json() = *std::move(taken);
    context.print(fmt::format("{}\n", picture_));
    return ExitCode::kDone;
  }

  std::string picture_;
  std::string look_ = "0,0";
  std::string content_;
  bool faults_ = false;
  sim::PretendOptions pretend_;
};

}  // namespace

std::unique_ptr<Command> sim() { return std::make_unique<Sim>(); }

}  // namespace raysteer::host::cli
