#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

#include "host/session/image_codec.hpp"

namespace raysteer::host::session {
namespace {

class File {
 public:
  explicit File(int handle) : handle_(handle) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() { close(); }
  bool is_open() const { return handle_ >= 0; }
  int handle() const { return handle_; }
  bool close() {
    const int handle = std::exchange(handle_, -1);
    return handle < 0 || ::close(handle) == 0;
  }

 private:
  int handle_;
};

std::string reason(int number) { return std::generic_category().message(number); }

}  // namespace

Result<std::vector<std::uint8_t>> read_file(const std::filesystem::path& path) {
  const File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) {
    const int number = errno;
    const bool missing = number == ENOENT || number == ENOTDIR;
    return fail(missing ? RCode::kFileMissing : RCode::kFileUnreadable,
                path.string() + (missing ? "" : ": " + reason(number)), number);
  }
  struct stat status {};
  if (::fstat(file.handle(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return fail(RCode::kFileUnreadable, path.string() + ": not a regular file");
  }
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::read(file.handle(), bytes.data() + done, bytes.size() - done);
    if (got < 0 && errno == EINTR) {
      continue;
    }
    if (got < 0) {
      return fail(RCode::kFileUnreadable, path.string() + ": " + reason(errno), errno);
    }
    if (got == 0) {
      return fail(RCode::kFileTruncated, path.string() + ": became shorter while it was read");
    }
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

Status write_file(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  // Written beside and renamed, so that the name never stands for half a file.
  const std::string beside = path.string() + ".part";
  const auto failed = [&](int number) -> Status {
    ::unlink(beside.c_str());
    return fail(number == ENOSPC || number == EDQUOT ? RCode::kDiskFull : RCode::kWriteFailed,
                path.string() + ": " + reason(number), number);
  };
  File file(::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  if (!file.is_open()) {
    return failed(errno);
  }
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::write(file.handle(), bytes.data() + done, bytes.size() - done);
    if (put < 0 && errno != EINTR) {
      return failed(errno);
    }
    done += put > 0 ? static_cast<std::size_t>(put) : 0;
  }
  if (!file.close() || ::rename(beside.c_str(), path.c_str()) != 0) {
    return failed(errno);
  }
  return ok();
}

}  // namespace raysteer::host::session
