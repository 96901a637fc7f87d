// A rendered rig taken through the commands as a technician would; folders of each step in a scratch folder.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/contract/cli/program.hpp"

namespace raysteer::support {

class Technician {
 public:
  explicit Technician(std::string board, std::string seed = "20261122")
      : board_(std::move(board)), seed_(std::move(seed)) {}

  std::string in(const std::string& name) const { return (folder_.path() / name).string(); }
  /// A file of tests/rig.
  static std::string data(const std::string& name) { return (source_root() / "tests/rig" / name).string(); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(in(name)) << text; }

  /// The command's one JSON object; it must end with `exit_code`.
  nlohmann::json run(std::vector<std::string> words, int exit_code = 0) const {
    words.insert(words.end(), {"--json", "--quiet"});
    const auto finished = host::cli::raysteer(words);
    EXPECT_EQ(finished.exit_code, exit_code) << words[0] << " " << words[1] << ": " << finished.out << finished.err;
    return host::cli::parse_one(finished.out);
  }

  void capture(const std::string& scene, const std::string& looks, const std::string& out,
               const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{"capture", "--sim",      "--board", board_,    "--seed", seed_,   "--scene",
                                   scene,     "--patterns", "fast",    "--looks", looks,    "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    run(words);
  }

  /// "cameras" by the target in scenes/floor.toml, then "rig" in the tied room of tests/rig/steered: found by made().
  /// Made once for each build of the programs, and kept in the build tree: tests run as many processes at once, of
  /// which one makes it and the others wait. What 'calibrate rig' said.
  nlohmann::json calibrate(const std::string& looks = "10", const std::string& check = "3") {
    namespace fs = std::filesystem;
    made_ = program_folder().parent_path() / "pretend-sessions" / ("rig-" + fs::path(board_).stem().string());
    fs::create_directories(made_.parent_path());
    const int lock = ::open((made_.string() + ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644);
    ::flock(lock, LOCK_EX);
    std::string stamp;
    for (const char* program : {"raysteer", "raysteer-sim"}) {
      stamp += std::to_string(fs::last_write_time(program_folder() / program).time_since_epoch().count()) + " ";
    }
    if (read_all(made_ / "stamp") != stamp) {
      fs::remove_all(made_);
      fs::create_directories(made_);
      capture("floor", "cameras", made("cameras-session"));
      run({"calibrate", "cameras", made("cameras-session"), "--out", made("cameras")});
      run({"plan", "looks", "--board", board_, "--looks", looks, "--check", check, "--out", made("plan")});
      capture(room(), made("plan/looks.toml"), made("looks"));
      // A verdict of 'redo' (5) is what a poor mirror deserves.
      const auto finished = host::cli::raysteer({"calibrate", "rig", made("looks"), "--cameras", made("cameras"),
                                                 "--board", board_, "--survey", data("steered/data/survey.toml"),
                                                 "--out", made("rig"), "--json", "--quiet"});
      EXPECT_TRUE(finished.exit_code == 0 || finished.exit_code == 5) << finished.out << finished.err;
      std::ofstream(made_ / "rig.json") << finished.out;
      std::ofstream(made_ / "stamp") << stamp;
    }
    ::close(lock);
    return host::cli::parse_one(read_all(made_ / "rig.json"));
  }
  /// What calibrate() left: "cameras-session", "cameras", "plan", "looks", "rig". Not to be written to.
  std::string made(const std::string& name) const { return (made_ / name).string(); }
  static std::string room() { return data("steered/data/scene.toml"); }

 private:
  std::string board_;
  std::string seed_;
  std::filesystem::path made_;
  ScratchFolder folder_;
};

}  // namespace raysteer::support
