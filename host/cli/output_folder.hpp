// bound to the main thread: --out DIR, which appears whole or not at all.
#pragma once

#include <filesystem>
#include <optional>

#include "hal/base/result.hpp"

namespace raysteer::host::cli {

/// A hidden neighbour of the folder asked for. commit() flushes it to the disk and renames it into place; without
/// commit() it is deleted, and what was there before stays as it was.
class OutputFolder {
 public:
  /// Errors: kOutputExists (holds files Raysteer did not write), kDiskFull, kWriteFailed.
  static Result<OutputFolder> make(const std::filesystem::path& wanted);
  OutputFolder(OutputFolder&& other) noexcept;
  OutputFolder& operator=(OutputFolder&&) = delete;
  ~OutputFolder();

  /// Where to write now.
  const std::filesystem::path& temporary() const { return temporary_; }
  /// Where it will be, absolute.
  const std::filesystem::path& wanted() const { return wanted_; }
  /// The earlier Raysteer output that will be replaced.
  std::optional<std::filesystem::path> previous() const;
  Status commit();

 private:
  OutputFolder() = default;
  std::filesystem::path wanted_;
  std::filesystem::path temporary_;  ///< empty after commit
  bool replaces_ = false;
};

}  // namespace raysteer::host::cli
