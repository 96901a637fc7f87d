// The framework with commands made for the test: --out, progress, cancelling, exceptions.
#include <gtest/gtest.h>
#include <pty.h>
#include <signal.h>
#include <sys/resource.h>

#include <array>
#include <filesystem>
#include <stdexcept>

#include "host/cli/run.hpp"
#include "host/exchange/write_file.hpp"
#include "tests/contract/cli/program.hpp"

namespace raysteer::host::cli {
namespace {

namespace fs = std::filesystem;
using support::Finished;
using support::ScratchFolder;

// Writes a file, then ends as told.
class Work : public Command {
 public:
  Manual manual() const override {
    return {.summary = "Work", .description = "", .example = "raysteer work", .out = TakesOut::kOptional};
  }
  void declare(Options& options) override {
    options.option("--end", "HOW", &end_, "how to end").choices({"done", "redo", "fail", "throw", "wait", "kill"});
    options.option("--text", "TEXT", &text_, "what to write");
    options.option("--bytes", "N", &bytes_, "how much more to write");
  }
  Result<ExitCode> run(Context& context) override {
    if (context.previous_out()) {
      context.json()["previous"] = support::read_all(*context.previous_out() / "file");
    }
    if (context.has_out()) {
      RAYSTEER_TRY(exchange::write_file(context.out() / "file", text_));
      RAYSTEER_TRY(exchange::write_file(context.out() / "big", std::string(static_cast<std::size_t>(bytes_), 'x')));
    }
    const Tick tick = context.stage("working");
    tick(0.5);
    context.json()["text"] = text_;
    context.print(text_ + "\n");
    if (end_ == "fail") {
      return fail(RCode::kSceneMoved, "frames 3 and 4");
    }
    if (end_ == "throw") {
      throw std::runtime_error("a library's surprise");
    }
    if (end_ == "kill") {
      ::raise(SIGKILL);
    }
    if (end_ == "wait") {
      context.note("ready");
      while (tick(0.5)) {
      }
      return fail(RCode::kCancelled);
    }
    return end_ == "redo" ? ExitCode::kVerdictRedo : ExitCode::kDone;
  }

 private:
  std::string end_ = "done";
  std::string text_ = "new";
  int bytes_ = 0;
};

constexpr std::array kCommands{
    CommandRow{"work", []() -> std::unique_ptr<Command> { return std::make_unique<Work>(); }}};
constexpr CommandTable kTable{kCommands, {}};

int work_here(std::vector<std::string> words) {
  words.insert(words.begin(), "work");
  return run(kTable, words);
}

Finished work(const std::vector<std::string>& words) {
  return support::in_child([&] { return work_here(words); });
}

using Names = std::vector<std::string>;

TEST(Out, appears_whole_and_leaves_nothing_beside) {
  const ScratchFolder folder;
  const std::string out = (folder / "deep/er/out").string();
  EXPECT_EQ(work({"--out", out + "/"}).exit_code, 0);
  EXPECT_EQ(support::read_all(fs::path(out) / "file"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep/er"), fs::directory_iterator()), 1);
}

TEST(Out, replaces_our_earlier_output_and_shows_it_to_the_command) {
  const ScratchFolder folder;
  const std::string out = (folder / "out").string();
  ASSERT_EQ(work({"--out", out, "--text", "old", "--bytes", "9"}).exit_code, 0);
  const Finished done = work({"--out", out, "--json"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(parse_one(done.out).at("previous"), "old");
  EXPECT_EQ(support::read_all(fs::path(out) / "file"), "new");
  EXPECT_EQ(folder.names(), Names{"out"});
}

TEST(Out, is_kept_with_the_verdict_redo) {
  const ScratchFolder folder;
  EXPECT_EQ(work({"--out", (folder / "out").string(), "--end", "redo"}).exit_code, 5);
  EXPECT_EQ(support::read_all(folder / "out/file"), "new");
}

TEST(Out, stays_as_it_was_when_the_command_fails) {
  for (const std::string end : {"fail", "throw"}) {
    const ScratchFolder folder;
    const std::string out = (folder / "out").string();
    EXPECT_EQ(work({"--out", out, "--end", end}).exit_code, 1);
    EXPECT_EQ(folder.names(), Names{}) << "no output, and no temporary one";
    ASSERT_EQ(work({"--out", out, "--text", "old"}).exit_code, 0);
    const Finished done = work({"--out", out, "--end", end});
    EXPECT_EQ(done.exit_code, 1);
    EXPECT_EQ(done.out, "") << "no result of a command that failed";
    EXPECT_EQ(support::read_all(folder / "out/file"), "old");
    EXPECT_EQ(folder.names(), Names{"out"});
  }
}

TEST(Out, refuses_what_is_not_ours_and_takes_an_empty_folder) {
  const ScratchFolder folder;
  fs::create_directory(folder / "empty");
  EXPECT_EQ(work({"--out", (folder / "empty").string()}).exit_code, 0);
  ASSERT_TRUE(exchange::write_file(folder / "file", "precious"));
  EXPECT_EQ(work({"--out", (folder / "file").string()}).exit_code, 4);
  EXPECT_EQ(work({"--out", folder.path().string()}).exit_code, 4);
  EXPECT_EQ(work({"--out", "/"}).exit_code, 4);
  EXPECT_EQ(support::read_all(folder / "file"), "precious");
  EXPECT_EQ(folder.names(), (Names{"empty", "file"}));
}

TEST(Out, leaves_nothing_when_a_write_fails_halfway) {
  const ScratchFolder folder;
  const std::string out = (folder / "out").string();
  ASSERT_EQ(work({"--out", out, "--text", "old"}).exit_code, 0);
  const Finished done = support::in_child([&] {
    const rlimit limit{4096, 4096};  // as a disk that is full after a page
    ::setrlimit(RLIMIT_FSIZE, &limit);
    return work_here({"--out", out, "--bytes", "100000"});
  });
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_NE(done.err.find("error[R0116]: a file cannot be written: "), std::string::npos) << done.err;
  EXPECT_EQ(support::read_all(folder / "out/file"), "old");
  EXPECT_EQ(folder.names(), Names{"out"});
}

TEST(Out, of_a_run_that_was_killed_is_cleared_away_by_the_next) {
  const ScratchFolder folder;
  const std::string out = (folder / "out").string();
  EXPECT_EQ(work({"--out", out, "--end", "kill"}).exit_code, 128 + SIGKILL);
  EXPECT_EQ(folder.names().size(), 1U) << "only the hidden neighbour";
  EXPECT_NE(folder.names().front(), "out");
  EXPECT_EQ(work({"--out", out}).exit_code, 0);
  EXPECT_EQ(folder.names(), Names{"out"});
}

TEST(Exceptions, of_libraries_become_errors) {
  const Finished done = work({"--end", "throw", "--json"});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_EQ(parse_one(done.out).at("error").at("code"), "R0506");
  EXPECT_NE(done.out.find("a library's surprise"), std::string::npos);
}

// Starts the command with standard error in a pipe, sends the signal once it has said that it is ready.
Finished cancel(int signal, const std::vector<std::string>& words) {
  std::array<int, 2> ends{};
  EXPECT_EQ(::pipe(ends.data()), 0);
  const ScratchFolder folder;
  std::fflush(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(ends[1], STDERR_FILENO);
    ::close(ends[0]);
    ::close(ends[1]);
    const int out = ::open((folder / "out").c_str(), O_WRONLY | O_CREAT, 0600);
    ::dup2(out, STDOUT_FILENO);
    const int code = work_here(words);
    std::fflush(nullptr);
    ::_exit(code);
  }
  ::close(ends[1]);
  Finished done;
  std::array<char, 256> block{};
  bool sent = false;
  for (ssize_t count = 0; (count = ::read(ends[0], block.data(), block.size())) > 0;) {
    done.err.append(block.data(), static_cast<std::size_t>(count));
    if (!sent && done.err.find("ready") != std::string::npos) {
      ::kill(child, signal);
      sent = true;
    }
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  done.exit_code = support::exit_code_of(status);
  done.out = support::read_all(folder / "out");
  return done;
}

TEST(Cancelling, exits_8_and_leaves_nothing_half_written) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const ScratchFolder folder;
    const Finished done = cancel(signal, {"--out", (folder / "out").string(), "--end", "wait"});
    EXPECT_EQ(done.exit_code, 8);
    EXPECT_NE(done.err.find("error[R0503]: cancelled"), std::string::npos) << done.err;
    EXPECT_EQ(folder.names(), Names{});
  }
}

TEST(Cancelling, is_said_in_json_too) {
  const Finished done = cancel(SIGINT, {"--end", "wait", "--json"});
  EXPECT_EQ(done.exit_code, 8);
  EXPECT_EQ(parse_one(done.out).at("error").at("code"), "R0503");
}

TEST(Progress, is_silent_in_a_pipe) {
  const Finished done = work({});
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(done.out, "new\n");
}

// What a terminal of `columns` gets to see on standard error.
std::string on_terminal(unsigned short columns, const std::vector<std::string>& words) {
  winsize size{};
  size.ws_row = 24;
  size.ws_col = columns;
  int terminal = -1;
  std::fflush(nullptr);
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    const int nowhere = ::open("/dev/null", O_WRONLY);
    ::dup2(nowhere, STDOUT_FILENO);
    ::_exit(work_here(words));
  }
  std::string seen;
  std::array<char, 256> block{};
  for (ssize_t count = 0; (count = ::read(terminal, block.data(), block.size())) > 0;) {
    seen.append(block.data(), static_cast<std::size_t>(count));
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(terminal);
  return seen;
}

TEST(Progress, shows_stage_and_percentage_on_a_terminal_and_is_removed) {
  const std::string seen = on_terminal(80, {});
  EXPECT_NE(seen.find("\rworking   0 %"), std::string::npos) << seen;
  EXPECT_TRUE(seen.ends_with("\r\033[K")) << seen;
  EXPECT_EQ(on_terminal(80, {"--quiet"}), "");
}

TEST(Progress, never_wraps_on_a_narrow_terminal) {
  const std::string seen = on_terminal(12, {});
  EXPECT_NE(seen.find("\rworki   0 %\033[K"), std::string::npos) << seen;
}

}  // namespace
}  // namespace raysteer::host::cli
