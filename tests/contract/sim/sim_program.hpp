// What tests of the pretend rig's program share: the two programs, and files to spoil.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace raysteer::sim {

namespace fs = std::filesystem;

inline support::Finished raysteer(std::vector<std::string> words) {
  words.insert(words.begin(), (support::program_folder() / "raysteer").string());
  return support::run_program(std::move(words));
}

/// "R0105" of what --json printed.
inline std::string code_of(const support::Finished& finished) {
  const nlohmann::json json = nlohmann::json::parse(finished.out, nullptr, false);
  return json.is_object() ? json.value("/error/code"_json_pointer, "") : "";
}

class SimProgram : public ::testing::Test {
 protected:
  fs::path work() const { return folder_.path(); }
  fs::path out() const { return work() / "out"; }

  /// A capture of the small board's fastest set into out(), with `more`.
  support::Finished capture(const std::vector<std::string>& more) const {
    std::vector<std::string> words{"capture", "--sim", "--json", "--patterns", "fast", "--out", out().string()};
    words.insert(words.end(), more.begin(), more.end());
    if (std::ranges::find(more, "--board") == more.end()) {
      words.insert(words.end(), {"--board", "mock-small"});
    }
    return raysteer(std::move(words));
  }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(work() / name) << text;
    return work() / name;
  }
  /// One of our files with its first `from` written as `to`.
  fs::path changed(const std::string& kind, const std::string& name, const std::string& from,
                   const std::string& to) const {
    std::string text = support::read_all(support::source_root() / kind / (name + ".toml"));
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return write(name + ".toml", text.replace(at, from.size(), to));
  }

  /// Its own code and exit code, the word that tells a person what is wrong, and nothing half-written.
  void expect_refused(const support::Finished& finished, const std::string& code, int exit_code,
                      const std::string& word) const {
    EXPECT_EQ(code_of(finished), code) << finished.out << finished.err;
    EXPECT_EQ(finished.exit_code, exit_code) << finished.out;
    EXPECT_NE(finished.out.find(word), std::string::npos) << finished.out;
    EXPECT_FALSE(fs::exists(out()));
    for (const std::string& name : folder_.names()) {
      EXPECT_FALSE(name.starts_with(".")) << "left behind: " << name;
    }
  }

 private:
  support::ScratchFolder folder_;
};

}  // namespace raysteer::sim
