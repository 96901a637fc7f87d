#include "sim/app/write_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace raysteer::sim::app {
namespace {

Error write_error(const std::filesystem::path& file, int number) {
  const RCode rcode = number == ENOSPC || number == EDQUOT ? RCode::kDiskFull : RCode::kWriteFailed;
  return fail(rcode, file.string() + ": " + std::strerror(number), number);
}

}  // namespace

Status write_whole(const std::filesystem::path& file, std::string_view bytes) {
  const std::filesystem::path beside = file.parent_path() / ("." + file.filename().string() + ".part");
  std::FILE* stream = std::fopen(beside.c_str(), "wb");
  if (stream == nullptr) {
    return write_error(file, errno);
  }
  errno = 0;
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stream) == bytes.size();
  const int wrong = errno;
  const bool closed = std::fclose(stream) == 0;
  if (!written || !closed || std::rename(beside.c_str(), file.c_str()) != 0) {
    const Error error = write_error(file, wrong != 0 ? wrong : errno);
    std::remove(beside.c_str());
    return error;
  }
  return ok();
}

}  // namespace raysteer::sim::app
