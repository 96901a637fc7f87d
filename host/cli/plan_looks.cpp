// raysteer plan looks: which looks to take, and what they will be worth, before a single shot.
#include <fmt/core.h>

#include <string>
#include <utility>

#include "calib/plan/looks.hpp"
#include "host/cli/commands.hpp"
#include "host/exchange/write_file.hpp"
#include "host/rig/drawing.hpp"
#include "host/rig/read_files.hpp"

namespace raysteer::host::cli {
namespace {

// Millimetres are taken for metres otherwise.
constexpr double kNearestM = 0.1;
constexpr double kFarthestM = 100;

class PlanLooks : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Plan the looks that calibrate a steered rig best",
            .description =
                "Chooses mirror commands that, by the board's drawing, leave predictions at all other looks with the "
                "least error (an I-optimal design), and further ones to check the result by. Says what accuracy to "
                "expect.\n\nWith --out DIR: looks.toml, a plan for 'raysteer capture'.",
            .example =
                "raysteer plan looks --board mock-galvo --out plan\n"
                "raysteer plan looks --board mock-head --looks 12 --distance 2.8 --json",
            .out = TakesOut::kOptional};
  }

  void declare(Options& options) override {
    options.option("--board", "FILE", &board_, "board file, or an installed one's name: how the rig is drawn")
        .required();
    options.option("--looks", "N", &looks_, "looks to solve from");
    options.option("--check", "N", &check_, "further looks, to check the result by");
    options.option("--distance", "M", &distance_, "of the floor below the cameras, metres");
  }

  Result<ExitCode> run(Context& context) override {
    if (!(distance_ >= kNearestM && distance_ <= kFarthestM)) {
      return fail(RCode::kBadValue, fmt::format("--distance is {}, expected {} to {}: it is in metres", distance_,
                                                kNearestM, kFarthestM));
    }
    const auto board = rig::read_board(board_);
    RAYSTEER_TRY(board);
    const auto drawing = rig::drawing_of(*board);
    RAYSTEER_TRY(drawing);
    const auto plan = calib::plan::plan_looks(*drawing, rig::cameras_of(*board), {.distance_m = distance_},
                                              {.looks = looks_, .held_out = check_, .measuring = {}});
    RAYSTEER_TRY(plan);
    std::string text = fmt::format(
        "# Looks for {}, planned by 'raysteer plan looks'. Expected at a look nobody has taken: {:.2f} px, {:.2f} mm.\n"
        "format = 1\nname = \"looks of {}\"\n",
        board->name, plan->prediction.unseen_px, plan->prediction.unseen_mm, board->name);
    int solved = 0;
    int held_out = 0;
    Json& json = context.json();
    for (const calib::plan::PlannedLook& look : plan->looks) {
      const std::string name =
          look.held_out ? fmt::format("check-{:02d}", ++held_out) : fmt::format("look-{:02d}", ++solved);
      text += fmt::format("\n[[look]]\nname = \"{}\"\nmirror_mrad = [{:.3f}, {:.3f}]\n", name,
                          1e3 * look.command_rad.x(), 1e3 * look.command_rad.y());
      json["looks"].push_back({{"name", name}, {"mirror_rad", {look.command_rad.x(), look.command_rad.y()}}});
    }
    json["expected"] = {{"model_px", plan->prediction.model_px},
                        {"model_mm", plan->prediction.model_mm},
                        {"unseen_px", plan->prediction.unseen_px},
                        {"unseen_mm", plan->prediction.unseen_mm}};
    context.print(fmt::format(
        "{} looks, {} to check: {:.2f} px, {:.2f} mm expected at a look nobody has taken (RMS; {:.2f} "
        "px with the loop closed there)\n",
        solved, held_out, plan->prediction.unseen_px, plan->prediction.unseen_mm, plan->prediction.model_px));
    if (plan->regular) {
      context.print("  a regular grid: too few commands are usable to choose from\n");
    }
    if (context.has_out()) {
      RAYSTEER_TRY(exchange::write_file(context.out() / "looks.toml", text));
    } else {
      context.print("\n" + text);
    }
    return ExitCode::kDone;
  }

 private:
  std::string board_;
  int looks_ = 16;
  int check_ = 8;
  double distance_ = 3.5;
};

}  // namespace

std::unique_ptr<Command> plan_looks() { return std::make_unique<PlanLooks>(); }

}  // namespace raysteer::host::cli
