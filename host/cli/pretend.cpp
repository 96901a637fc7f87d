#include "host/cli/pretend.hpp"

#include <memory>
#include <string>
#include <utility>

namespace raysteer::host::cli {

void declare_pretend(Options& options, sim::PretendOptions& pretend) {
  options.option("--board", "FILE", &pretend.board, "board file, or an installed one's name: mock-galvo, mock-head");
  options.option("--scene", "FILE", &pretend.scene, "scene file, or an installed one's name: floor, step, factory");
  options.option("--seed", "N", &pretend.seed, "draws the rig and its noise; 1 if not given");
  options.option("--fault", "FAULT", &pretend.faults,
                 "what goes wrong, as left.drop@2s*3; may be given again. 'raysteer sim --faults' lists them");
  options.option("--threads", "N", &pretend.threads, "threads that trace; all cores if not given");
}

sim::Listener listen(Context& context) {
  struct Stage {
    std::string name;
    Tick tick;
  };
  return {.progress =
              [&context, stage = std::make_shared<Stage>()](const std::string& name, double done) {
                if (!stage->tick || stage->name != name) {
                  *stage = {name, context.stage(name)};
                }
                stage->tick(done);
              },
          .note = [&context](const std::string& line) { context.note(line); },
          .cancelled = [] { return Context::cancelled(); }};
}

}  // namespace raysteer::host::cli
