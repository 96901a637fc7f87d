#include "host/session/session.hpp"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>
#include <type_traits>
#include <utility>

namespace raysteer::host::session {
namespace fs = std::filesystem;
namespace {

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

bool is_inside(const fs::path& real_file, const fs::path& folder) {
  std::error_code error;
  const fs::path real_folder = fs::canonical(folder, error);
  if (error) {
    return false;
  }
  const fs::path relative = real_file.lexically_relative(real_folder);
  return !relative.empty() && *relative.begin() != "..";
}

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

Result<Session> Session::open(const fs::path& named, const std::optional<fs::path>& frames_root) {
  std::error_code not_there;
  const fs::path file = fs::is_directory(named, not_there) ? named / "session.toml" : named;
  Session session;
  session.file_ = file;
  const fs::path home = folder_of(file);
  Result<std::vector<std::uint8_t>> bytes = read_file(file);
  if (!bytes) {
    return std::move(bytes).error();
  }
  const auto load = [&](const std::string& path) -> Result<std::string> {
    Result<std::vector<std::uint8_t>> included = read_file(home / path);
    if (!included) {
      return std::move(included).error();
    }
    std::error_code error;
    if (!is_inside(fs::canonical(home / path, error), home) || error) {
      return fail(RCode::kPathOutside, "a symbolic link leads out of the session's folder");
    }
    return text_of(*included);
  };
  Result<proto::session::Manifest> manifest = proto::session::read_manifest(text_of(*bytes), file.string(), load);
  if (!manifest) {
    return std::move(manifest).error();
  }
  session.manifest_ = std::move(*manifest);
  RAYSTEER_TRY(session.find_frames(home, frames_root));
  RAYSTEER_TRY(session.find_sizes());
  return session;
}

Status Session::find_frames(const fs::path& home, const std::optional<fs::path>& frames_root) {
  std::vector<fs::path> folders;
  if (frames_root) {
    folders.push_back(*frames_root);
  }
  folders.push_back(home);
  if (const char* named = std::getenv("RAYSTEER_DATA_DIR"); named != nullptr && !frames_root) {
    folders.emplace_back(named);
  }

  std::vector<std::string> names;
  std::vector<FrameId> ids;
  for (int look = 0; look < looks(); ++look) {
    for (int camera = 0; camera < cameras(); ++camera) {
      for (int index = 0; index < frames_per_look(); ++index) {
        ids.push_back({camera, look, index});
        names.push_back(name(ids.back()));
      }
    }
  }
  std::error_code error;
  frames_folder_ = folders.front();
  for (const fs::path& folder : folders) {
    const auto is_there = [&](const std::string& name) { return fs::exists(folder / name, error); };
    if (std::any_of(names.begin(), names.end(), is_there)) {
      frames_folder_ = folder;
      break;
    }
  }

  int missing = 0;
  std::string first;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const fs::path file = frames_folder_ / names[i];
    const fs::path real = fs::canonical(file, error);
    if (error) {
      first = missing++ == 0 ? describe(ids[i]) : first;
      continue;
    }
    const auto holds = [&](const fs::path& folder) { return is_inside(real, folder); };
    if (std::none_of(folders.begin(), folders.end(), holds)) {
      return fail(RCode::kPathOutside, describe(ids[i]) + ": a symbolic link leads to " + real.string());
    }
  }
  if (missing > 0) {
    std::string searched;
    for (const fs::path& folder : folders) {
      searched += (searched.empty() ? "" : ", ") + folder.string();
    }
    const std::string others = missing > 1 ? "; " + std::to_string(missing - 1) + " others are missing, too" : "";
    return fail(RCode::kFrameMissing, first + others + "; looked in " + searched, missing);
  }
  return ok();
}

Status Session::find_sizes() {
  sizes_.resize(manifest_.cameras.size());
  for (int camera = 0; camera < cameras(); ++camera) {
    const proto::session::Camera& said = manifest_.cameras[static_cast<std::size_t>(camera)];
    const FrameId first{camera, 0, 0};
    Result<std::vector<std::uint8_t>> bytes = read_file(path(first));
    if (!bytes) {
      return with_context(std::move(bytes).error(), describe(first));
    }
    const Result<ImageHeader> header = read_header(*bytes);
    if (!header) {
      return with_context(header.error(), describe(first));
    }
    if (header->bits != said.bits) {
      return fail(RCode::kFrameDepth, describe(first) + ": the session says " + std::to_string(said.bits) +
                                          " bits, the file holds " + std::to_string(header->bits));
    }
    if (said.width > 0 && (header->width != said.width || header->height != said.height)) {
      return fail(RCode::kFrameSize, describe(first) + ": the session says " + std::to_string(said.width) + " x " +
                                         std::to_string(said.height) + " px, the file holds " +
                                         std::to_string(header->width) + " x " + std::to_string(header->height));
    }
    sizes_[static_cast<std::size_t>(camera)] = {header->width, header->height};
  }
  return ok();
}

std::optional<int> Session::look_number(const std::string& name) const {
  for (int look = 0; look < looks(); ++look) {
    if (manifest_.looks[static_cast<std::size_t>(look)].name == name) {
      return look;
    }
  }
  return std::nullopt;
}

std::string Session::name(const FrameId& id) const {
  return proto::session::file_name(manifest_, manifest_.cameras[static_cast<std::size_t>(id.camera)],
                                   manifest_.looks[static_cast<std::size_t>(id.look)], id.index);
}

fs::path Session::path(const FrameId& id) const { return frames_folder_ / name(id); }

std::string Session::describe(const FrameId& id) const {
  return "frame " + std::to_string(id.index) + " of camera '" +
         manifest_.cameras[static_cast<std::size_t>(id.camera)].name + "', look '" +
         manifest_.looks[static_cast<std::size_t>(id.look)].name + "' (" + name(id) + ")";
}

template <class Pixel>
Status Session::load_as(const FrameId& id, Image<Pixel>& into) const {
  Result<std::vector<std::uint8_t>> bytes = read_file(path(id));
  if (!bytes) {
    Error error = std::move(bytes).error();
    if (error.rcode == RCode::kFileMissing) {
      error.rcode = RCode::kFrameMissing;
    }
    return with_context(std::move(error), describe(id));
  }
  if (Status status = decode_image(*bytes, into); !status) {
    return with_context(std::move(status).error(), describe(id));
  }
  if (into.width() != width(id.camera) || into.height() != height(id.camera)) {
    return fail(RCode::kFrameSize, describe(id) + " has " + std::to_string(into.width()) + " x " +
                                       std::to_string(into.height()) + " px, expected " +
                                       std::to_string(width(id.camera)) + " x " + std::to_string(height(id.camera)));
  }
  return ok();
}

Status Session::load(const FrameId& id, Image<std::uint8_t>& into) const { return load_as(id, into); }
Status Session::load(const FrameId& id, Image<std::uint16_t>& into) const { return load_as(id, into); }

Result<Frame> Session::frame(const FrameId& id) const {
  const auto load_one = [&](auto image) -> Result<Frame> {
    RAYSTEER_TRY(load_as(id, image));
    return Frame(std::move(image));
  };
  return bits(id.camera) == 8 ? load_one(Image<std::uint8_t>()) : load_one(Image<std::uint16_t>());
}

}  // namespace raysteer::host::session
