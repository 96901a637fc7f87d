#include "firmware/capture/session_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <span>
#include <string>
#include <system_error>
#include <utility>
#include <variant>

#include "proto/session/raw_frame.hpp"

namespace raysteer::firmware::capture {
namespace {

namespace fs = std::filesystem;
using proto::session::Manifest;
using proto::session::Shot;
using Bytes = std::span<const std::uint8_t>;

constexpr const char* kSession = "session.toml";
constexpr const char* kKept = "capture.toml";

Error write_error(const fs::path& file, int number) {
  const RCode rcode = number == ENOSPC || number == EDQUOT ? RCode::kDiskFull : RCode::kWriteFailed;
  return fail(rcode, file.string() + ": " + std::strerror(number), number);
}

// Writes beside the name and renames, so that the name stands for all bytes or for none.
Status write_whole(const fs::path& file, std::initializer_list<Bytes> parts, bool lasting) {
  const fs::path beside = file.string() + ".part";
  const int handle = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (handle < 0) {
    return write_error(file, errno);
  }
  int wrong = 0;
  for (const Bytes part : parts) {
    for (std::size_t done = 0; done < part.size() && wrong == 0;) {
      const ssize_t count = ::write(handle, part.data() + done, part.size() - done);
      if (count >= 0) {
        done += static_cast<std::size_t>(count);
      } else if (errno != EINTR) {
        wrong = errno;
      }
    }
  }
  if (wrong == 0 && lasting && ::fsync(handle) != 0) {
    wrong = errno;
  }
  if (::close(handle) != 0 && wrong == 0) {
    wrong = errno;
  }
  if (wrong == 0 && ::rename(beside.c_str(), file.c_str()) != 0) {
    wrong = errno;
  }
  if (wrong != 0) {
    ::unlink(beside.c_str());
    return write_error(file, wrong);
  }
  return ok();
}

Bytes bytes_of(const std::string& text) { return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}; }

Result<std::string> read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) {
    return fail(RCode::kFileUnreadable, file.string());
  }
  return std::string(std::istreambuf_iterator<char>(in), {});
}

// What an earlier capture must have in common to be gone on with.
bool same_capture(Manifest a, Manifest b) {
  for (Manifest* manifest : {&a, &b}) {
    manifest->shots.clear();
    manifest->exposure_us.reset();
  }
  return a == b;
}

}  // namespace

Result<std::optional<Manifest>> SessionWriter::open(const Manifest& manifest) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) {
    return write_error(folder_, error.value());
  }
  if (fs::exists(folder_ / kSession, error)) {
    return fail(RCode::kOutputExists, folder_.string() + " holds a finished session");
  }
  if (!fs::exists(folder_ / kKept, error)) {
    return std::optional<Manifest>();
  }
  auto text = read_text(folder_ / kKept);
  if (!text) {
    return std::move(text).error();
  }
  const auto no_includes = [](const std::string& path) -> Result<std::string> {
    return fail(RCode::kFileMissing, path);
  };
  auto kept = proto::session::read_manifest(*text, (folder_ / kKept).string(), no_includes);
  if (!kept) {
    return std::move(kept).error();
  }
  if (!same_capture(*kept, manifest)) {
    return fail(RCode::kCaptureForeign, folder_.string() + " holds the beginning of '" + kept->name +
                                            "', whose plan, patterns or cameras are not those of '" + manifest.name +
                                            "'");
  }
  return std::optional(std::move(*kept));
}

Status SessionWriter::put(const Manifest& manifest, const Shot& shot, hal::FramePair pair) {
  const auto look = std::ranges::find(manifest.looks, shot.look, &proto::session::Look::name);
  RAYSTEER_CHECK(look != manifest.looks.end());
  for (const hal::Eye eye : hal::kEyes) {
    const proto::session::Camera& camera = manifest.cameras[static_cast<std::size_t>(eye)];
    const fs::path file = folder_ / file_name(manifest, camera, *look, shot.index);
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    if (error) {
      return write_error(file, error.value());
    }
    RAYSTEER_TRY(std::visit(
        [&](const auto& pixels) {
          const auto header = proto::session::raw_header(pixels.width(), pixels.height(), 8 * sizeof(*pixels.data()));
          const Bytes body{reinterpret_cast<const std::uint8_t*>(pixels.data()),
                           pixels.size() * sizeof(*pixels.data())};
          return write_whole(file, {header, body}, false);
        },
        pair.eye(eye)->pixels));
  }
  return ok();
}

Status SessionWriter::keep(const Manifest& manifest) {
  const std::string text = write_manifest(manifest);
  return write_whole(folder_ / kKept, {bytes_of(text)}, true);
}

Status SessionWriter::finish(const Manifest& manifest) {
  const std::string text = write_manifest(manifest);
  RAYSTEER_TRY(write_whole(folder_ / kSession, {bytes_of(text)}, true));
  std::error_code error;
  fs::remove(folder_ / kKept, error);  // harmless if it stays
  return ok();
}

}  // namespace raysteer::firmware::capture
