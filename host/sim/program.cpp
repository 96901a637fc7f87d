#include "host/sim/program.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

namespace raysteer::host::sim {
namespace {

constexpr int kPollMs = 100;
constexpr std::chrono::seconds kPatience{5};  // from being asked to end until it is made to

// A file descriptor that is closed when it goes.
class Pipe {
 public:
  Pipe() {
    if (::pipe2(ends_.data(), O_CLOEXEC) != 0) {
      ends_ = {-1, -1};
    }
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int reads() const { return ends_[0]; }
  int writes() const { return ends_[1]; }
  void close_end(std::size_t end) {
    if (ends_[end] >= 0) {
      ::close(ends_[end]);
      ends_[end] = -1;
    }
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

std::filesystem::path program() {
  std::error_code error;
  return std::filesystem::read_symlink("/proc/self/exe", error).parent_path() / "raysteer-sim";
}

// In a process group of its own, so that Ctrl-C reaches us alone, and gone when we are.
pid_t start(const std::string& path, std::vector<std::string>& arguments, Pipe& out, Pipe& err) {
  std::vector<char*> words;
  for (std::string& argument : arguments) {
    words.push_back(argument.data());
  }
  words.push_back(nullptr);
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child != 0) {
    return child;
  }
  // Only what POSIX allows between fork and exec.
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) {
    ::_exit(127);
  }
  ::dup2(out.writes(), STDOUT_FILENO);
  ::dup2(err.writes(), STDERR_FILENO);
  ::execv(path.c_str(), words.data());
  ::_exit(127);
}

std::optional<RCode> rcode_of(std::string_view text) {
  int number = 0;
  if (!text.starts_with('R') ||
      std::from_chars(text.data() + 1, text.data() + text.size(), number).ptr != text.data() + text.size()) {
    return std::nullopt;
  }
  const std::span<const RCode> all = all_rcodes();
  const auto found = std::ranges::find(all, number, [](RCode rcode) { return static_cast<int>(rcode); });
  return found == all.end() ? std::nullopt : std::optional(*found);
}

// What the lines said so far.
struct Story {
  std::optional<Json> result;
  std::optional<Error> error;
};

void hear(const std::string& line, const Listener& listener, Story& story) {
  const Json event = Json::parse(line, nullptr, false);
  if (!event.is_object()) {
    return;
  }
  if (event.contains("result")) {
    story.result = event["result"];
  } else if (event.contains("error") && event["error"].is_object()) {
    const RCode rcode = rcode_of(event["error"].value("code", "")).value_or(RCode::kInternal);
    story.error = fail(rcode, event["error"].value("note", ""));
  } else if (event.contains("stage") && listener.progress) {
    listener.progress(event.value("stage", ""), event.value("done", 0.0));
  } else if (event.contains("note") && listener.note) {
    listener.note(event.value("note", ""));
  }
}

// Bytes that are there; false at the end.
bool read_some(int file, std::string& into) {
  std::array<char, 4096> bytes{};
  const ssize_t count = ::read(file, bytes.data(), bytes.size());
  if (count > 0) {
    into.append(bytes.data(), static_cast<std::size_t>(count));
  }
  return count > 0 || (count < 0 && errno == EINTR);
}

std::string ending(int status) {
  return WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status)) + " ended it"
                             : "exit code " + std::to_string(WEXITSTATUS(status));
}

// The last lines of a long complaint.
std::string tail(const std::string& text) {
  constexpr std::size_t kMost = 2000;
  return text.size() <= kMost ? text : "... " + text.substr(text.size() - kMost);
}

}  // namespace

Result<Json> run(std::vector<std::string> arguments, const Listener& listener) {
  const std::string path = program().string();
  if (::access(path.c_str(), X_OK) != 0) {
    return fail(RCode::kPretendRigMissing,
                path + ": " + std::strerror(errno) +
                    "; the pretend rig's program stands beside raysteer when both are "
                    "installed or built",
                errno);
  }
  arguments.insert(arguments.begin(), path);
  arguments.emplace_back("--events");
  Pipe out;
  Pipe err;
  const pid_t child = start(path, arguments, out, err);
  if (child < 0 || out.reads() < 0 || err.reads() < 0) {
    return fail(RCode::kPretendRigMissing, path + " cannot be started: " + std::strerror(errno), errno);
  }
  out.close_end(1);
  err.close_end(1);

  Story story;
  std::string lines;
  std::string complaint;
  std::optional<std::chrono::steady_clock::time_point> asked_to_end;
  std::array<pollfd, 2> files{pollfd{out.reads(), POLLIN, 0}, pollfd{err.reads(), POLLIN, 0}};
  while (files[0].fd >= 0 || files[1].fd >= 0) {
    ::poll(files.data(), files.size(), kPollMs);
    if (files[0].revents != 0 && !read_some(out.reads(), lines)) {
      files[0].fd = -1;  // poll() leaves it out
    }
    if (files[1].revents != 0 && !read_some(err.reads(), complaint)) {
      files[1].fd = -1;
    }
    for (std::size_t end = lines.find('\n'); end != std::string::npos; end = lines.find('\n')) {
      hear(lines.substr(0, end), listener, story);
      lines.erase(0, end + 1);
    }
    const auto now = std::chrono::steady_clock::now();
    if (!asked_to_end && listener.cancelled && listener.cancelled()) {
      asked_to_end = now;
      ::kill(child, SIGTERM);
    } else if (asked_to_end && now - *asked_to_end > kPatience) {
      ::kill(child, SIGKILL);
    }
  }
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (asked_to_end) {
    return fail(RCode::kCancelled);
  }
  if (story.error) {
    return *std::move(story.error);
  }
  if (!story.result || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    return fail(RCode::kPretendRigDied, "raysteer-sim ended without a result: " + ending(status) +
                                            (complaint.empty() ? "" : ": " + tail(complaint)));
  }
  return *std::move(story.result);
}

}  // namespace raysteer::host::sim
