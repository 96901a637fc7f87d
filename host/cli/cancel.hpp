// shared: Ctrl-C and termination signals become a flag that stages poll.
#pragma once

namespace raysteer::host::cli {

/// From now on SIGINT and SIGTERM set the flag; a second one ends the program at once. Broken pipes and file size
/// limits become write errors instead of signals.
void listen_for_signals();

bool cancel_requested();

}  // namespace raysteer::host::cli
