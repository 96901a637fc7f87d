// The built program, as a user runs it.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/paths.hpp"
#include "tests/support/process.hpp"

namespace raysteer::host::cli {

inline support::Finished raysteer(std::vector<std::string> words) {
  words.insert(words.begin(), (support::program_folder() / "raysteer").string());
  return support::run_program(std::move(words));
}

/// Exactly one JSON object, or a discarded value.
inline nlohmann::json parse_one(const std::string& text) { return nlohmann::json::parse(text, nullptr, false); }

}  // namespace raysteer::host::cli
