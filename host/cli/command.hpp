// contract: one command of `raysteer`. One file a command; all are listed in commands.cpp.
//
//   class Scan : public Command {
//     Manual manual() const override { return {.summary = "Make a point cloud from a session", .example = "...", ...};
//     } void declare(Options& options) override {
//       options.argument("SESSION", &session_, "session file or its folder");
//       options.option("--calibration", "FILE", &calibration_, "calibration to scan with").required();
//     }
//     Result<ExitCode> run(Context& context) override {
//       auto tick = context.stage("decoding");
//       ...                                        // RAYSTEER_TRY(...), tick(0.5), write_file(context.out() / ...)
//       context.json()["points"] = points;         // --json
//       context.print(fmt::format("{} points\n", points));
//       return ExitCode::kDone;                    // or kVerdictRedo: the output is kept, and the exit code is 5
//     }
//   };
//   std::unique_ptr<Command> scan() { return std::make_unique<Scan>(); }   // declared in commands.hpp
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"
#include "host/cli/context.hpp"
#include "host/cli/exit_code.hpp"
#include "host/cli/options.hpp"

namespace raysteer::host::cli {

enum class TakesOut { kNo, kOptional, kRequired };

/// What --help and the man page say, and which common options there are.
struct Manual {
  std::string_view summary;      ///< one line, imperative, no full stop: "Make a point cloud from a session"
  std::string_view description;  ///< a paragraph or two; may be empty
  std::string_view example;      ///< command lines that work, one a line; --help ends with them
  TakesOut out = TakesOut::kNo;
  bool takes_frames = false;
  bool has_json = true;
};

class Command {
 public:
  virtual ~Command() = default;
  virtual Manual manual() const = 0;
  virtual void declare(Options& options) = 0;
  /// Errors of any kind are printed by the framework, as text or as JSON; --out is then left as it was.
  virtual Result<ExitCode> run(Context& context) = 0;
};

}  // namespace raysteer::host::cli
