// raysteer-sim: the pretend rig as a program. People mostly meet it through
// `raysteer capture --sim` and `raysteer sim`.
#include <CLI/CLI.hpp>
#include <array>
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "sim/app/modes.hpp"

namespace raysteer::sim::app {
namespace {

void declare(CLI::App& mode, WhichRig& which) {
  mode.add_option("--board", which.board, "board file, or the name of an installed one");
  mode.add_option("--scene", which.scene, "scene file, or the name of an installed one");
  mode.add_option("--seed", which.seed, "draws the rig and its noise");
  mode.add_option("--fault", which.faults, "what goes wrong, as left.drop@2s*3")->take_all()->allow_extra_args(false);
  mode.add_option("--threads", which.threads, "threads that trace; 0: all cores");
}

int run(int count, char** words) {
  CLI::App app("The pretend rig: mock devices in a ray-traced world", "raysteer-sim");
  app.require_subcommand(1);
  bool events = false;
  const auto mode = [&](const char* name, const char* what) {
    CLI::App* added = app.add_subcommand(name, what);
    added->add_flag("--events", events, "lines of JSON on standard output (docs/sim-events.md)");
    return added;
  };

  CaptureRequest capturing;
  CLI::App* capture_mode = mode("capture", "run a plan and write a session");
  declare(*capture_mode, capturing.which);
  capture_mode->add_option("--patterns", capturing.patterns, "default, fast, best or gray");
  capture_mode->add_option("--looks", capturing.looks, "plan file, or the name of an installed one");
  capture_mode->add_option("--out", capturing.out, "the session's folder")->required();
  capture_mode->add_flag("--paced", capturing.paced, "not faster than the wall clock");

  PictureRequest picturing;
  CLI::App* picture_mode = mode("picture", "save what a person in the room sees");
  declare(*picture_mode, picturing.which);
  picture_mode->add_option("--picture", picturing.picture, "PNG file")->required();
  std::vector<double> look;
  picture_mode->add_option("--look", look, "mirror angles, milliradians")->delimiter(',')->expected(2);
  picture_mode->add_option("--content", picturing.content, "grey PNG of the panel's size");

  ShowRequest showing;
  CLI::App* show_mode = mode("show", "show pictures at one look (docs/show-format.md)");
  declare(*show_mode, showing.which);
  show_mode->add_option("--request", showing.request, "request.json")->required();
  show_mode->add_option("--out", showing.out, "folder for what was seen")->required();

  CLI::App* faults_mode = mode("faults", "list the words that --fault knows");

  try {
    app.parse(count, words);
  } catch (const CLI::CallForHelp& asked) {
    return app.exit(asked);
  } catch (const CLI::Error& error) {
    return Say(events).error(fail(RCode::kUsage, std::string("raysteer-sim: ") + error.what()));
  }
  if (look.size() == 2) {
    picturing.mirror_mrad = {look[0], look[1]};
  }
  listen_for_signals();
  Say say(events);
  const Result<Json> result = [&]() -> Result<Json> {
    try {
      return capture_mode->parsed()   ? capture(capturing, say)
             : picture_mode->parsed() ? picture(picturing, say)
             : show_mode->parsed()    ? show(showing, say)
             : faults_mode->parsed()  ? Result<Json>(faults())
                                      : fail(RCode::kUsage, "raysteer-sim: no mode");
    } catch (const std::exception& exception) {
      return fail(RCode::kInternal, exception.what());
    }
  }();
  if (!result) {
    return say.error(result.error());
  }
  say.result(*result);
  return 0;
}

}  // namespace
}  // namespace raysteer::sim::app

int main(int count, char** words) { return raysteer::sim::app::run(count, words); }
