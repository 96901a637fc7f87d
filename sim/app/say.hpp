// bound to the main thread: how raysteer-sim tells how it is getting on: lines
// of JSON for a program, text for people.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "hal/base/result.hpp"

namespace raysteer::sim::app {

using Json = nlohmann::ordered_json;

class Say {
 public:
  /// `events`: one JSON object a line on standard output (docs/sim-events.md).
  /// Else the result alone goes there, and progress, a line per tenth, and
  /// notes to standard error.
  explicit Say(bool events) : events_(events) {}

  void progress(const std::string& stage, double done);
  void note(const std::string& line);
  void result(const Json& result);
  /// Returns the exit code, as `raysteer` has them.
  int error(const Error& error);

 private:
  bool events_;
  std::string stage_;
  int tenths_ = -1;
};

/// Has Ctrl-C or a termination signal come since listen_for_signals()?
void listen_for_signals();
bool cancelled();

}  // namespace raysteer::sim::app
