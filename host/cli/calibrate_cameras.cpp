// raysteer calibrate cameras: pictures of a board become calibrated cameras.
#include <string>
#include <utility>

#include "host/cli/calibrate.hpp"
#include "host/cli/commands.hpp"
#include "host/session/session.hpp"

namespace raysteer::host::cli {
namespace {

class CalibrateCameras : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Calibrate one camera or two from pictures of a board",
            .description =
                "Finds the session's board in every look (the layout of a ChArUco board is found out), adjusts lenses, "
                "poses and the board's sag together, and says how good the result is on corners it has not seen.\n\n"
                "With --out DIR: calibration.toml with its covariance, exports for OpenCV and Kalibr, result.json and "
                "report.html. When DIR holds an earlier calibration, the report shows the difference.",
            .example =
                "raysteer calibrate cameras board.toml --out calibration\n"
                "raysteer calibrate cameras board.toml --frames captures --json",
            .out = TakesOut::kOptional,
            .takes_frames = true};
  }

  void declare(Options& options) override {
    options.argument("SESSION", &session_, "session file or its folder").required();
    options.option("--lens", "MODEL", &lens_, "lens model; auto chooses by held-out corners")
        .choices({"auto", "bc4", "bc5", "bc8"});
    options.option("--previous", "FILE", &previous_, "earlier calibration to compare with");
  }

  Result<ExitCode> run(Context& context) override {
    CalibrateInput input{.session = session_, .previous = previous_, .options = {}};
    RAYSTEER_TRY(set_lens(lens_, input.options));
    const auto session = session::Session::open(session_, context.frames_root());
    if (!session) {
      return session.error();
    }
    const auto gathered = calibrate::gather_cameras(*session, context.stage("finding boards"));
    if (!gathered) {
      return gathered.error();
    }
    return calibrate(context, *gathered, std::move(input));
  }

 private:
  std::string session_;
  std::string lens_ = "auto";
  std::string previous_;
};

}  // namespace

std::unique_ptr<Command> calibrate_cameras() { return std::make_unique<CalibrateCameras>(); }

}  // namespace raysteer::host::cli
