#include "host/exchange/write_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace raysteer::host::exchange {
namespace fs = std::filesystem;

Error write_error(const fs::path& path, int error_number) {
  const bool full = error_number == ENOSPC || error_number == EDQUOT;
  return fail(full ? RCode::kDiskFull : RCode::kWriteFailed,
              path.string() + " (" + std::generic_category().message(error_number) + ")", error_number);
}

Status write_file(const fs::path& path, std::string_view bytes) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) {
    return write_error(path, errno);
  }
  int failure = 0;
  while (!bytes.empty() && failure == 0) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      failure = errno;
    }
  }
  // Special files such as /dev/stdout cannot be flushed to a disk: that is no fault.
  if (failure == 0 && ::fsync(file) != 0 && errno != EINVAL && errno != EROFS) {
    failure = errno;
  }
  if (::close(file) != 0 && failure == 0) {
    failure = errno;
  }
  if (failure != 0) {
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored)) {
      fs::remove(path, ignored);
    }
    return write_error(path, failure);
  }
  return ok();
}

Status replace_file(const fs::path& path, std::string_view bytes) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_regular_file(path, error)) {
    if (fs::is_directory(path, error)) {
      return write_error(path, EISDIR);
    }
    return write_file(path, bytes);  // a pipe or a device has no neighbour to be renamed from
  }
  const fs::path temporary =
      path.parent_path() / ("." + path.filename().string() + ".raysteer-" + std::to_string(::getpid()));
  if (Status written = write_file(temporary, bytes); !written) {
    Error renamed = std::move(written).error();
    return write_error(path, static_cast<int>(renamed.detail));
  }
  fs::rename(temporary, path, error);
  if (error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    return write_error(path, error.value());
  }
  return ok();
}

Result<std::string> read_file(const fs::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) {
    return fail(errno == ENOENT || errno == ENOTDIR ? RCode::kFileMissing : RCode::kFileUnreadable,
                path.string() + " (" + std::generic_category().message(errno) + ")", errno);
  }
  std::string bytes;
  struct stat facts {};
  if (::fstat(file, &facts) == 0 && facts.st_size > 0) {
    bytes.reserve(static_cast<std::size_t>(facts.st_size) + 1);
  }
  char block[65536];
  ssize_t count = 0;
  while ((count = ::read(file, block, sizeof block)) != 0) {
    if (count < 0) {
      if (errno == EINTR) {
        continue;
      }
      const int failure = errno;
      ::close(file);
      return fail(RCode::kFileUnreadable, path.string() + " (" + std::generic_category().message(failure) + ")",
                  failure);
    }
    bytes.append(block, static_cast<std::size_t>(count));
  }
  ::close(file);
  return bytes;
}

}  // namespace raysteer::host::exchange
