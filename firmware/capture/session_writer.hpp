// bound to capture: shots become a session folder (docs/session-format.md), raw frames and session.toml.
//
// Every file is written beside its name and renamed, so that none is ever half there. session.toml comes last: a folder
// without it is no session. Until then capture.toml, of the same format, lists the shots that are kept; a capture of
// the same plan into the same folder goes on from them.
#pragma once

#include <filesystem>

#include "firmware/capture/sink.hpp"

namespace raysteer::firmware::capture {

class SessionWriter : public Sink {
 public:
  /// Makes the folder when it is not there.
  explicit SessionWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  Result<std::optional<proto::session::Manifest>> open(const proto::session::Manifest& manifest) override;
  Status put(const proto::session::Manifest& manifest, const proto::session::Shot& shot, hal::FramePair pair) override;
  Status keep(const proto::session::Manifest& manifest) override;
  Status finish(const proto::session::Manifest& manifest) override;

 private:
  std::filesystem::path folder_;
};

}  // namespace raysteer::firmware::capture
