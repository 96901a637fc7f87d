#include "host/cli/cancel.hpp"

#include <signal.h>

#include <atomic>

namespace raysteer::host::cli {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void request(int) { requested.store(true); }

}  // namespace

void listen_for_signals() {
  struct sigaction action {};
  action.sa_handler = request;
  // SA_RESETHAND: whoever presses Ctrl-C twice means it. SA_RESTART: reads and writes under way are finished.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  struct sigaction before {};
  if (::sigaction(SIGINT, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) {  // a shell's background job
    ::sigaction(SIGINT, &action, nullptr);
  }
  ::sigaction(SIGTERM, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
}

bool cancel_requested() { return requested.load(std::memory_order_relaxed); }

}  // namespace raysteer::host::cli
