#include "host/cli/output_folder.hpp"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "host/exchange/write_file.hpp"

namespace raysteer::host::cli {
namespace {
namespace fs = std::filesystem;

// Says that a folder is ours to replace.
constexpr const char* kMarker = ".raysteer-output";
constexpr const char* kInfix = ".raysteer-";

std::string temporary_prefix(const fs::path& wanted) { return "." + wanted.filename().string() + kInfix; }

// Neighbours left by runs that were killed the hard way.
void remove_stale(const fs::path& wanted) {
  std::error_code error;
  const std::string prefix = temporary_prefix(wanted);
  for (const fs::directory_entry& entry : fs::directory_iterator(wanted.parent_path(), error)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(prefix)) {
      continue;
    }
    pid_t writer = 0;
    const char* end = name.data() + name.size();
    const auto parsed = std::from_chars(name.data() + prefix.size(), end, writer);
    if (parsed.ec == std::errc() && parsed.ptr == end && writer > 0 && ::kill(writer, 0) != 0 && errno == ESRCH) {
      std::error_code ignored;
      fs::remove_all(entry.path(), ignored);
    }
  }
}

Status flush(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return exchange::write_error(path, errno);
  }
  const int failure = ::fsync(file) == 0 || errno == EINVAL ? 0 : errno;
  ::close(file);
  if (failure != 0) {
    return exchange::write_error(path, failure);
  }
  return ok();
}

}  // namespace

Result<OutputFolder> OutputFolder::make(const fs::path& wanted) {
  OutputFolder folder;
  std::error_code error;
  // A symbolic link to a folder stays a link: its target is replaced.
  folder.wanted_ = fs::weakly_canonical(fs::absolute(wanted), error);
  if (error) {
    return exchange::write_error(wanted, error.value());
  }
  if (!folder.wanted_.has_filename()) {
    folder.wanted_ = folder.wanted_.parent_path();
  }
  if (folder.wanted_ == folder.wanted_.root_path()) {
    return fail(RCode::kOutputExists, "--out " + wanted.string() + " is the root of the file system");
  }
  const fs::file_status status = fs::status(folder.wanted_, error);
  if (fs::exists(status)) {
    if (!fs::is_directory(status)) {
      return fail(RCode::kOutputExists, wanted.string() + " is a file; --out takes a folder");
    }
    folder.replaces_ = true;
    if (!fs::exists(folder.wanted_ / kMarker, error)) {
      const fs::directory_iterator first(folder.wanted_, error);
      if (error) {
        return exchange::write_error(wanted, error.value());
      }
      if (first != fs::directory_iterator()) {
        return fail(RCode::kOutputExists,
                    wanted.string() + " holds '" + first->path().filename().string() + "' and no " + kMarker);
      }
    }
  }
  fs::create_directories(folder.wanted_.parent_path(), error);
  if (error) {
    return exchange::write_error(folder.wanted_.parent_path(), error.value());
  }
  remove_stale(folder.wanted_);
  const fs::path temporary =
      folder.wanted_.parent_path() / (temporary_prefix(folder.wanted_) + std::to_string(::getpid()));
  if (::mkdir(temporary.c_str(), 0777) != 0) {
    return exchange::write_error(temporary, errno);
  }
  folder.temporary_ = temporary;
  RAYSTEER_TRY(
      exchange::write_file(temporary / kMarker, "Written by raysteer --out, which may replace this folder.\n"));
  return folder;
}

OutputFolder::OutputFolder(OutputFolder&& other) noexcept
    : wanted_(std::move(other.wanted_)),
      temporary_(std::exchange(other.temporary_, fs::path())),
      replaces_(other.replaces_) {}

OutputFolder::~OutputFolder() {
  if (!temporary_.empty()) {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);
  }
}

std::optional<fs::path> OutputFolder::previous() const { return replaces_ ? std::optional(wanted_) : std::nullopt; }

Status OutputFolder::commit() {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(temporary_, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->is_regular_file() || entry->is_directory()) {
      RAYSTEER_TRY(flush(entry->path()));
    }
  }
  if (error) {
    return exchange::write_error(temporary_, error.value());
  }
  RAYSTEER_TRY(flush(temporary_));
  if (!replaces_) {
    if (::rename(temporary_.c_str(), wanted_.c_str()) != 0) {
      return exchange::write_error(wanted_, errno);
    }
  } else if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, wanted_.c_str(), RENAME_EXCHANGE) == 0) {
    std::error_code ignored;
    fs::remove_all(temporary_, ignored);  // now the earlier output
  } else {
    // The file system cannot exchange: step aside, rename, and put back what was there if that fails.
    const fs::path aside = temporary_.string() + ".old";
    if (::rename(wanted_.c_str(), aside.c_str()) != 0) {
      return exchange::write_error(wanted_, errno);
    }
    if (::rename(temporary_.c_str(), wanted_.c_str()) != 0) {
      const int failure = errno;
      (void)::rename(aside.c_str(), wanted_.c_str());
      return exchange::write_error(wanted_, failure);
    }
    std::error_code ignored;
    fs::remove_all(aside, ignored);
  }
  temporary_.clear();
  return flush(wanted_.parent_path());
}

}  // namespace raysteer::host::cli
