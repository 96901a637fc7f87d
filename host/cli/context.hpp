// bound to the main thread (but for stage() and cancelled()): what the framework gives a running command.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "hal/base/result.hpp"

namespace raysteer::host::cli {

class OutputFolder;
class Progress;

/// Keeps the order in which keys were set.
using Json = nlohmann::ordered_json;

/// The options every command takes.
struct CommonOptions {
  bool json = false;
  bool quiet = false;
  bool verbose = false;
  std::string color = "auto";
  std::string out;     ///< --out DIR; empty: none
  std::string frames;  ///< --frames DIR; empty: none
};

/// Called now and then with the part done (0 to 1), from any thread. False: stop soon and return kCancelled.
using Tick = std::function<bool(double done)>;

class Context {
 public:
  Context(CommonOptions options, OutputFolder* out, Progress& progress);

  // Results: standard output.

  /// The object printed with --json; a command fills it in any case (result.json and tests read it too).
  Json& json() { return json_; }
  bool wants_json() const { return options_.json; }
  /// Human text of the result, with its line ends; appears when the command has succeeded, and not with --json.
  void print(std::string_view text) { text_ += text; }
  const std::string& text() const { return text_; }

  // Side remarks: standard error.

  /// One line, for example a warning. Nothing with --quiet.
  void note(std::string_view line);
  /// One line, only with -v.
  void detail(std::string_view line);
  /// Starts a stage ("finding boards"); its percentage and remaining time show on a terminal.
  Tick stage(std::string name);

  // Stopping.

  /// Has Ctrl-C or a termination signal come? Stages poll it (or the Tick) several times a second.
  static bool cancelled();
  /// ok, or kCancelled: RAYSTEER_TRY(context.poll());
  static Status poll();

  // Files.

  bool has_out() const { return out_ != nullptr; }
  /// Write here (has_out() must hold). It is a hidden neighbour that becomes --out DIR, whole or not at all, after
  /// the command returned a value. Write with exchange::write_file, which notices a full disk.
  const std::filesystem::path& out() const;
  /// The earlier Raysteer output in --out DIR that is going to be replaced, if any: to compare with.
  std::optional<std::filesystem::path> previous_out() const;
  /// Where --out DIR will be, for messages.
  std::filesystem::path final_out() const;
  /// Root of the session's file names: --frames DIR, else RAYSTEER_DATA_DIR, else nothing.
  std::optional<std::filesystem::path> frames_root() const;

 private:
  CommonOptions options_;
  OutputFolder* out_;
  Progress& progress_;
  Json json_ = Json::object();
  std::string text_;
};

}  // namespace raysteer::host::cli
