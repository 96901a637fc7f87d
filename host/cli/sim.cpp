// raysteer sim: the pretend rig itself, seen by a person in its room.
#include <fmt/core.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/pretend.hpp"
#include "host/cli/sim_tour.hpp"

namespace raysteer::host::cli {
namespace {

/// Off the middle, so that "straight" is not what comes by itself; every corner of the picture passes both mirrors.
constexpr const char* kTourLook = "40,-30";

/// "20,-10" in milliradians as radians. kUsage.
Result<std::array<double, 2>> angles(const std::string& text) {
  std::array<double, 2> mrad{};
  const char* const end = text.data() + text.size();
  const auto first = std::from_chars(text.data(), end, mrad[0]);
  const bool comma = first.ec == std::errc() && first.ptr != end && *first.ptr == ',';
  const auto second = comma ? std::from_chars(first.ptr + 1, end, mrad[1]) : first;
  if (!comma || second.ec != std::errc() || second.ptr != end || !std::isfinite(mrad[0]) || !std::isfinite(mrad[1])) {
    return fail(RCode::kUsage, "--look is two angles in mrad, as 20,-10, not '" + text + "'");
  }
  return std::array{1e-3 * mrad[0], 1e-3 * mrad[1]};
}

class Sim : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Look at the pretend rig: its first straight rectangle, its room, and what can go wrong",
            .description =
                "The pretend rig behaves like a real one, down to lag, noise, distortion and faults, in a room whose "
                "light is traced.\n\n"
                "--tour goes the whole way once: it calibrates both cameras from pictures of a waved board, finds the "
                "floor from the board lying on it, poses the projector by discs shown beside the board, bakes a "
                "rectangle of 50 x 31.25 cm that is level to the camera, shows it, and says by how many millimetres "
                "its corners miss the truth. The picture before and after goes to --picture, else "
                "before-after.png; --out DIR keeps all that was recorded too.\n\n"
                "--picture FILE alone saves what a person in the room sees, at the mirror position --look "
                "and with --content on the projector (white if not given). --faults lists the faults that --fault "
                "knows. 'raysteer capture --sim' records sessions with it.",
            .example =
                "raysteer sim --tour\n"
                "raysteer sim --tour --board mock-head --seed 7 --out tour --json\n"
                "raysteer sim --faults\n"
                "raysteer sim --scene factory --picture room.png\n"
                "raysteer sim --board mock-head --look 20,-10 --content drawing.png --picture room.png",
            .out = TakesOut::kOptional};
  }

  void declare(Options& options) override {
    options.flag("--tour", tour_, "calibrate one look, bake one rectangle, measure it");
    options.option("--picture", "FILE", &picture_, "save what a person in the room sees, as PNG");
    options.option("--look", "MRAD,MRAD", &look_,
                   "where the mirror stands: two mechanical angles; 0,0 if not given (the tour: 40,-30)");
    options.option("--content", "FILE", &content_, "grey PNG of the panel's size to project; white if not given");
    options.flag("--faults", faults_, "list the faults that can be asked for");
    declare_pretend(options, pretend_);
  }

  Result<ExitCode> run(Context& context) override {
    if (pretend_.scene.empty()) {
      pretend_.scene = tour_ ? "floor" : "step";
    }
    if (tour_ && !faults_ && content_.empty()) {
      const auto look = angles(look_.empty() ? kTourLook : look_);
      if (!look) {
        return look.error();
      }
      return run_tour(context, pretend_, *look, picture_.empty() ? "before-after.png" : picture_);
    }
    if (tour_ || context.has_out() || faults_ != picture_.empty()) {
      return fail(RCode::kUsage, "raysteer sim: give one of --tour, --picture FILE, --faults");
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
    words.insert(words.end(), {"--picture", picture_, "--look=" + (look_.empty() ? "0,0" : look_)});
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
  std::string look_;
  std::string content_;
  bool faults_ = false;
  bool tour_ = false;
  sim::PretendOptions pretend_{.board = "mock-galvo", .scene = "", .seed = 1, .faults = {}, .threads = 0};
};

}  // namespace

std::unique_ptr<Command> sim() { return std::make_unique<Sim>(); }

}  // namespace raysteer::host::cli
