// truth.json beside a rendered or pretended session: the rig and the surfaces as they are, to compare results with.
// docs/truth-format.md.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/rig.hpp"
#include "calib/model/steered_projector.hpp"
#include "calib/synth/scene.hpp"
#include "hal/base/result.hpp"

namespace raysteer::host::pretend {

inline constexpr const char* kTruthFile = "truth.json";

/// Corners in the rig's frame, metres.
using Triangle = std::array<Eigen::Vector3d, 3>;

struct TruthFile {
  std::uint64_t seed = 0;
  calib::model::Rig rig;                 ///< without covariance
  calib::synth::Scene scene;             ///< of the first look; prints are not written
  std::vector<Triangle> triangles = {};  ///< surfaces of the pretend rig's room; read only
  bool has_surfaces = true;              ///< all of them; false: some are too fine to be written
  /// Of the pretend rig; read only. What the mirror does besides (lag, repeatability, drift) is not in it.
  std::optional<calib::model::SteeredProjector> projector = {};
  std::optional<calib::model::Pose> T_room_rig = {};  ///< of the pretend rig; read only
  /// Where the mirror stood at each look, mechanical angles with all that it errs by; read only.
  std::map<std::string, Eigen::Vector2d> angles_rad = {};
};

std::string to_json(const TruthFile& truth);
/// Errors: kBadValue.
Result<TruthFile> truth_from_json(std::string_view text);

/// The truth beside the session file, or nothing for a session that was not rendered.
Result<std::optional<TruthFile>> truth_beside(const std::filesystem::path& session_file);

/// Distances of points (rig frame) to the nearest true surface, metres.
struct SurfaceError {
  double rms_m = 0;
  double p95_m = 0;
};
SurfaceError surface_error(const TruthFile& truth, std::span<const Eigen::Vector3d> points);

/// Distance to the nearest point of a triangle.
double distance_to(const Triangle& triangle, const Eigen::Vector3d& p);

/// A solved rig against the true one, devices of the same name.
struct RigError {
  double focal = 0;            ///< largest relative error of a focal length
  double centre_px = 0;        ///< largest error of a principal point's coordinate
  double baseline_m = 0;       ///< error of the distance between the first device and the second
  double chi_square = 0;       ///< all parameters by the solve's own covariance
  int degrees_of_freedom = 0;  ///< chi_square is about this, give or take sqrt(2 * this), when both are right
};
/// Nothing when no device of `solved` is in `truth`, or a lens model differs so that parameters do not compare.
std::optional<RigError> rig_error(const calib::model::Rig& solved, const calib::model::Rig& truth);

}  // namespace raysteer::host::pretend
