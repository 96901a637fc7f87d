// pure: what commands that use the pretend rig share: their options, and its progress as ours.
#pragma once

#include "host/cli/context.hpp"
#include "host/cli/options.hpp"
#include "host/sim/pretend_options.hpp"
#include "host/sim/program.hpp"

namespace raysteer::host::cli {

/// --board, --scene, --seed, --fault, --threads.
void declare_pretend(Options& options, sim::PretendOptions& pretend);

/// Progress, notes and Ctrl-C of `context`, which outlives it.
sim::Listener listen(Context& context);

}  // namespace raysteer::host::cli
