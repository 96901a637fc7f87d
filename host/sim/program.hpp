// bound to the main thread: starts raysteer-sim, the pretend rig, which stands beside this program.
//
// It says how it is getting on in lines of JSON on its standard output (docs/sim-events.md), and its last one is the
// result or the error, which becomes ours.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::host::sim {

using Json = nlohmann::ordered_json;

/// Empty ones are not called.
struct Listener {
  std::function<void(const std::string& stage, double done)> progress;
  std::function<void(const std::string& line)> note;  ///< "shot 7 of look 'a' is taken again: ..."
  std::function<bool()> cancelled;                    ///< asked some ten times a second
};

/// Runs `raysteer-sim ARGUMENTS --events` to its end and returns what it reports. Its error is returned as it is;
/// besides: kFileMissing: there is no raysteer-sim; kInternal: it ended without a result, says how, and what it wrote
/// to standard error; kCancelled: it was stopped, and has ended.
Result<Json> run(std::vector<std::string> arguments, const Listener& listener);

}  // namespace raysteer::host::sim
