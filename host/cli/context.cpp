#include "host/cli/context.hpp"

#include <cstdio>
#include <cstdlib>
#include <utility>

#include "host/cli/cancel.hpp"
#include "host/cli/output_folder.hpp"
#include "host/cli/progress.hpp"

namespace raysteer::host::cli {

Context::Context(CommonOptions options, OutputFolder* out, Progress& progress)
    : options_(std::move(options)), out_(out), progress_(progress) {}

void Context::note(std::string_view line) {
  if (!options_.quiet) {
    progress_.clear();
    std::fprintf(stderr, "%.*s\n", static_cast<int>(line.size()), line.data());
  }
}

void Context::detail(std::string_view line) {
  if (options_.verbose) {
    note(line);
  }
}

Tick Context::stage(std::string name) {
  progress_.start(name);
  return [&progress = progress_, name = std::move(name)](double done) {
    progress.at(name, done);
    return !cancelled();
  };
}

bool Context::cancelled() { return cancel_requested(); }

Status Context::poll() {
  if (cancelled()) {
    return fail(RCode::kCancelled);
  }
  return ok();
}

const std::filesystem::path& Context::out() const {
  RAYSTEER_CHECK(out_ != nullptr);
  return out_->temporary();
}

std::optional<std::filesystem::path> Context::previous_out() const {
  return out_ == nullptr ? std::nullopt : out_->previous();
}

std::filesystem::path Context::final_out() const {
  RAYSTEER_CHECK(out_ != nullptr);
  return out_->wanted();
}

std::optional<std::filesystem::path> Context::frames_root() const {
  if (!options_.frames.empty()) {
    return options_.frames;
  }
  if (const char* named = std::getenv("RAYSTEER_DATA_DIR"); named != nullptr && *named != '\0') {
    return named;
  }
  return std::nullopt;
}

}  // namespace raysteer::host::cli
