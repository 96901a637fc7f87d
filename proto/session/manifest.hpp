// value: what a session file says, and the way from its text and back (docs/session-format.md).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/pattern.hpp"
#include "hal/base/result.hpp"
#include "hal/base/target.hpp"

namespace raysteer::proto::session {

/// The only version of the format so far.
inline constexpr int kFormat = 1;

struct Camera {
  std::string name;     ///< "left"; unique in the session
  std::string files;    ///< file-name template with '/', knows {camera} {look} {index} {index:02}; see file_name()
  int first_index = 0;  ///< what {index} is for the first frame of the sequence
  int width = 0;        ///< px; 0 in both: whatever the first frame has
  int height = 0;
  int bits = 8;  ///< 8 or 16: bits of a pixel in the files
  bool operator==(const Camera&) const = default;
};

/// One mirror direction, or one pose of a board: the sequence is shown once for each.
struct Look {
  std::string name;                                 ///< unique in the session
  std::optional<std::vector<double>> command = {};  ///< what the mirror was told, in radians; one number per axis
  std::string note = {};
  bool operator==(const Look&) const = default;
};

/// A calibration target and where it is to be seen.
struct Target {
  TargetSpec spec;                 ///< spec.square_m is 0 where the file does not say it
  std::vector<std::string> looks;  ///< names of looks; empty: every look shows it
  bool operator==(const Target&) const = default;
};

/// What was recorded of one trigger. Everything but look and index may be absent.
struct Shot {
  std::string look;
  int index = 0;  ///< frame of the sequence
  std::optional<std::int64_t> sequence_number;
  std::optional<std::int64_t> rig_time_ns;      ///< rig clock at the command
  std::optional<std::int64_t> trigger_time_ns;  ///< rig clock at the trigger
  std::optional<std::int64_t> exposure_us;
  std::optional<std::vector<double>> mirror_command;   ///< radians
  std::optional<std::vector<double>> mirror_feedback;  ///< radians
  std::vector<std::int64_t> camera_times_ns;           ///< each camera's own clock, in the order of the cameras
  bool operator==(const Shot&) const = default;
};

struct Manifest {
  std::string name;
  std::string rig;     ///< which rig (board identity); may be empty
  std::string note;    ///< may be empty
  std::string frames;  ///< folder that all file names start in; may be empty
  std::optional<double> exposure_us;
  std::vector<Camera> cameras;  ///< 1 or 2; the first is "left", the origin of the rig
  PatternSequence sequence;     ///< shown once for each look
  std::vector<Look> looks;      ///< at least one
  std::vector<Target> targets;  ///< may be empty
  std::vector<Shot> shots;      ///< may be empty

  /// The target that `look` shows, or nullptr.
  const TargetSpec* target_of(std::string_view look) const;
  bool operator==(const Manifest&) const = default;
};

/// Gives the text of an included file. `path` is relative to the session's folder, with '/', and never leaves it.
using Loader = std::function<Result<std::string>(const std::string& path)>;

/// Reads a session. `file` is the name used in messages ("demo.toml:12: ...") and for finding circular includes.
/// Errors, each with file and line: kTomlSyntax, kFormatVersion, kUnknownKey (with the nearest known key), kMissingKey,
/// kBadValue, kPathOutside, kCircularInclude, kBadSequence, and whatever `load` answers.
Result<Manifest> read_manifest(std::string_view text, const std::string& file, const Loader& load);

/// The same session as text; read_manifest() gives back an equal value. No include is written.
std::string write_manifest(const Manifest& manifest);

/// The name of one file, relative to the session's folder or the frames root: manifest.frames + '/' + the template.
std::string file_name(const Manifest& manifest, const Camera& camera, const Look& look, int index);

}  // namespace raysteer::proto::session
