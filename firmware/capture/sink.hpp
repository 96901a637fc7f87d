// bound to capture: where verified shots go.
#pragma once

#include <optional>

#include "hal/base/result.hpp"
#include "hal/stereo_camera.hpp"
#include "proto/session/manifest.hpp"

namespace raysteer::firmware::capture {

/// Contract. Capture calls open() once, then put() for each verified shot, keep() whenever what was taken so far should
/// survive (a look ended, the capture paused or failed), and finish() once. A shot may be put again: the later one
/// counts. The manifest is whole but for its shots, which grow.
class Sink {
 public:
  Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  virtual ~Sink() = default;

  /// What an interrupted capture of the same plan left: its manifest with the shots that are kept; nothing when it
  /// starts afresh. kCaptureForeign: something else is there.
  virtual Result<std::optional<proto::session::Manifest>> open(const proto::session::Manifest& manifest) = 0;
  /// Takes the pixels. kDiskFull, kWriteFailed.
  virtual Status put(const proto::session::Manifest& manifest, const proto::session::Shot& shot,
                     hal::FramePair pair) = 0;
  /// kDiskFull, kWriteFailed.
  virtual Status keep(const proto::session::Manifest& manifest) = 0;
  /// Only now is it a session. kDiskFull, kWriteFailed.
  virtual Status finish(const proto::session::Manifest& manifest) = 0;
};

}  // namespace raysteer::firmware::capture
