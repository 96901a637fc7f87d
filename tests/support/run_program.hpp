// Runs the raysteer program that was built beside the test, as a user would.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/paths.hpp"

namespace raysteer::support {

struct Outcome {
  int exit_code = -1;   ///< -1: a signal ended it
  std::string printed;  ///< standard output
  nlohmann::json json;  ///< the same, where it is JSON; else null
  std::string error_code() const { return json.is_object() ? json.value("/error/code"_json_pointer, "") : ""; }
};

inline std::string quoted(const std::string& word) {
  std::string safe = "'";
  for (const char letter : word) {
    safe += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  }
  return safe + "'";
}

/// `before` goes in front of the program in a shell: "ulimit -f 8;". Standard error is dropped.
inline Outcome run_raysteer(const std::vector<std::string>& words, const std::string& before = "") {
  std::string command = before + " " + quoted((program_folder() / "raysteer").string());
  for (const std::string& word : words) {
    command += " " + quoted(word);
  }
  Outcome outcome;
  FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) {
    return outcome;
  }
  char piece[4096];
  while (const std::size_t count = std::fread(piece, 1, sizeof piece, pipe)) {
    outcome.printed.append(piece, count);
  }
  const int status = ::pclose(pipe);
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  outcome.json = nlohmann::json::parse(outcome.printed, nullptr, false);
  return outcome;
}

}  // namespace raysteer::support
