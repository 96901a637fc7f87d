// raysteer calibrate projector: a board under projected patterns becomes a calibrated camera and projector.
#include <string>
#include <utility>

#include "host/cli/calibrate.hpp"
#include "host/cli/commands.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

class CalibrateProjector : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Calibrate a projector and its camera from a board under patterns",
            .description =
                "Decodes the patterns on the board in every look and adjusts camera, projector and board poses "
                "together; the projector's principal point may lie outside its panel (lens shift). The answer does "
                "not depend on a first guess.\n\n"
                "With --out DIR: calibration.toml with its covariance, exports, result.json and report.html.",
            .example =
                "raysteer calibrate projector board.toml --out calibration\n"
                "raysteer calibrate projector board.toml --start-focal 4000 --json",
            .out = TakesOut::kOptional,
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
    options.option("--start-focal", "PX", &start_focal_,
                   "first guess of the projector's focal length (0: none needed)");
    options.option("--lens", "MODEL", &lens_, "lens model of the camera; auto chooses by held-out corners")
        .choices({"auto", "bc4", "bc5", "bc8"});
    options.option("--previous", "FILE", &previous_, "earlier calibration to compare with");
  }

  Result<ExitCode> run(Context& context) override {
    CalibrateInput input{.session = session_, .previous = previous_, .options = {}};
    RAYSTEER_TRY(set_lens(lens_, input.options));
    if (!(start_focal_ >= 0)) {
      return fail(RCode::kUsage, "--start-focal must not be negative");
    }
    input.options.projector_start_px = start_focal_;
    const auto session = session::Session::open(session_, context.frames_root());
    if (!session) {
      return session.error();
    }
    const auto gathered = calibrate::gather_projector(*session, context.stage("decoding"));
    if (!gathered) {
      return gathered.error();
    }
    return calibrate(context, *gathered, std::move(input));
  }

 private:
  std::string session_;
  std::string lens_ = "auto";
  std::string previous_;
  double start_focal_ = 0;
};

}  // namespace

std::unique_ptr<Command> calibrate_projector() { return std::make_unique<CalibrateProjector>(); }

}  // namespace raysteer::host::cli
