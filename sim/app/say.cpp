#include "sim/app/say.hpp"

#include <fmt/core.h>
#include <signal.h>

#include <atomic>
#include <cstdio>

namespace raysteer::sim::app {
namespace {

// A signal handler can reach nothing but a global.
std::atomic<bool> requested{false};
extern "C" void request(int) { requested.store(true); }

void print_line(const Json& object) {
  fmt::print("{}\n", object.dump(-1, ' ', false, Json::error_handler_t::replace));
  std::fflush(stdout);
}

// docs/cli.md, "Exit codes".
int exit_code(RCode rcode) {
  constexpr int kFailed = 1;
  constexpr int kUsage = 2;
  constexpr int kNotFound = 3;
  constexpr int kRefused = 4;
  constexpr int kTimedOut = 7;
  constexpr int kCancelled = 8;
  switch (rcode == RCode::kUsage ? ErrorCode::kUnknown : explain(rcode).code) {
    case ErrorCode::kNotFound:
      return kNotFound;
    case ErrorCode::kPermissionDenied:
    case ErrorCode::kAlreadyExists:
      return kRefused;
    case ErrorCode::kDeadlineExceeded:
      return kTimedOut;
    case ErrorCode::kCancelled:
      return kCancelled;
    default:
      return rcode == RCode::kUsage ? kUsage : kFailed;
  }
}

}  // namespace

void Say::progress(const std::string& stage, double done) {
  const int tenths = static_cast<int>(done * 10);
  if (events_) {
    print_line({{"stage", stage}, {"done", done}});
  } else if (stage != stage_ || tenths != tenths_) {
    fmt::print(stderr, "{} {:.0f} %\n", stage, 100 * done);
  }
  stage_ = stage;
  tenths_ = tenths;
}

void Say::note(const std::string& line) {
  if (events_) {
    print_line({{"note", line}});
  } else {
    fmt::print(stderr, "{}\n", line);
  }
}

void Say::result(const Json& result) {
  if (events_) {
    print_line({{"result", result}});
  } else {
    fmt::print("{}\n", result.dump(2, ' ', false, Json::error_handler_t::replace));
  }
}

int Say::error(const Error& error) {
  if (events_) {
    print_line({{"error", {{"code", to_string(error.rcode)}, {"note", error.note}}}});
  } else {
    const Explanation& row = explain(error.rcode);
    fmt::print(stderr, "error[{}]: {}\ncause: {}\nremedy: {}\n", to_string(error.rcode), error.message(), row.cause,
               row.remedy);
  }
  return exit_code(error.rcode);
}

void listen_for_signals() {
  struct sigaction action {};
  action.sa_handler = request;
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);  // twice means it
  ::sigaction(SIGINT, &action, nullptr);
  ::sigaction(SIGTERM, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
}

bool cancelled() { return requested.load(std::memory_order_relaxed); }

}  // namespace raysteer::sim::app
