// raysteer sim --tour: the first straight rectangle. Inside host/cli.
#pragma once

#include <array>
#include <filesystem>

#include "host/cli/command.hpp"
#include "host/sim/pretend_options.hpp"

namespace raysteer::host::cli {

/// Runs the tour, fills the JSON object and the text. With --out everything it recorded stays there, before-after.png
/// among it; without, only `picture` does. Errors: those of tour::tour, and of writing.
Result<ExitCode> run_tour(Context& context, const sim::PretendOptions& pretend, std::array<double, 2> mirror_rad,
                          const std::filesystem::path& picture);

}  // namespace raysteer::host::cli
