// shared: a recorded session on disk: its manifest, and its frames on demand.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "host/session/image_codec.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::host::session {

/// Which frame: numbers of the camera and the look in the manifest, and of the frame in the sequence.
struct FrameId {
  int camera = 0;
  int look = 0;
  int index = 0;
};

class Session {
 public:
  /// Reads the session file (of a folder: the session.toml in it), and makes sure that every frame is there (existence
  /// only; nothing is decoded but the header of each camera's first frame). `frames_root` is --frames; without it the
  /// variable RAYSTEER_DATA_DIR counts. Frames are taken from the first of these folders that has any of them:
  /// --frames, the session's folder, RAYSTEER_DATA_DIR. Errors: those of read_manifest(), kFileMissing,
  /// kFileUnreadable, kFrameMissing (names camera, look, index, path, and how many others are missing), kPathOutside,
  /// kFrameSize, kFrameDepth, kFrameFormat.
  static Result<Session> open(const std::filesystem::path& named,
                              const std::optional<std::filesystem::path>& frames_root = {});

  const proto::session::Manifest& manifest() const { return manifest_; }
  const std::filesystem::path& file() const { return file_; }
  /// The folder that the file names are relative to.
  const std::filesystem::path& frames_folder() const { return frames_folder_; }
  int cameras() const { return static_cast<int>(manifest_.cameras.size()); }
  int looks() const { return static_cast<int>(manifest_.looks.size()); }
  int frames_per_look() const { return manifest_.sequence.frames(); }
  /// Size of every frame of a camera, px.
  int width(int camera) const { return sizes_[static_cast<std::size_t>(camera)].width; }
  int height(int camera) const { return sizes_[static_cast<std::size_t>(camera)].height; }
  int bits(int camera) const { return manifest_.cameras[static_cast<std::size_t>(camera)].bits; }
  /// Number of the look with this name.
  std::optional<int> look_number(const std::string& name) const;
  std::filesystem::path path(const FrameId& id) const;
  /// "frame 7 of camera 'left', look 'pose_0' (left/07.jpg)", for messages.
  std::string describe(const FrameId& id) const;

  /// Loads one frame; any number of threads may do so at once. `into` is reused when it has the right size.
  /// The 8-bit one is for cameras of 8 bits, the 16-bit one for cameras of 16.
  /// Errors: kFrameMissing, kFileUnreadable, kFileTruncated, kFrameFormat, kFrameSize, kFrameDepth; all name the frame.
  Status load(const FrameId& id, Image<std::uint8_t>& into) const;
  Status load(const FrameId& id, Image<std::uint16_t>& into) const;
  /// Of either depth.
  Result<Frame> frame(const FrameId& id) const;

 private:
  struct Size {
    int width = 0;
    int height = 0;
  };
  Session() = default;
  Status find_frames(const std::filesystem::path& home, const std::optional<std::filesystem::path>& frames_root);
  Status find_sizes();
  std::string name(const FrameId& id) const;
  template <class Pixel>
  Status load_as(const FrameId& id, Image<Pixel>& into) const;

  proto::session::Manifest manifest_;
  std::filesystem::path file_;
  std::filesystem::path frames_folder_;
  std::vector<Size> sizes_;  // one a camera
};

}  // namespace raysteer::host::session
