// pure: stations of a room as the solved rig sees them: where to aim, and how sure it is of each corner.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calib/bake/content.hpp"
#include "calib/bake/station.hpp"
#include "calib/steer/room.hpp"
#include "hal/base/result.hpp"
#include "host/rig/scene.hpp"
#include "proto/stations/stations.hpp"

namespace raysteer::host::rig {

/// What dots at a station said (host/rig/close_loop.hpp).
struct Refined {
  Eigen::Vector2d latent_rad;  ///< the mirror stood so far off its command
  std::size_t dots = 0;
  /// 95 % bound once the mirror has been aimed again: better than open loop only where it drifted.
  double again_95_mm = 0;
  bool stands = true;  ///< nothing was looked at since, so the mirror may still stand there
};

struct AimedStation {
  calib::bake::Station station;                 ///< its command is set
  calib::bake::Content content;                 ///< what of the picture belongs where
  bool to_scale = true;                         ///< in its own plane, looked at along the plane's normal
  std::array<Eigen::Vector3d, 4> corners_room;  ///< where the picture's corners lie, on the surface
  std::array<Eigen::Vector3d, 4> normals_room;  ///< of the surface there
  std::array<Eigen::Vector3d, 4> sights_room;   ///< the way each is looked at: what is off along it does not show
  std::array<Eigen::Vector2d, 4> panel;         ///< px that should light the corners
  std::array<double, 4> bound_95_mm{};          ///< 95 % of errors are below, the mirror's repeatability included
  double worst_95_mm = 0;
  double missing = 0;  ///< share of the picture under which the scan has no surface

  std::array<std::optional<double>, 4> scan_sigma_m{};  ///< of corners on a scanned surface, along the left eye's ray
  calib::steer::LookState state{};                      ///< what the bounds know of the mirror's angles
  std::optional<Refined> refined{};

  bool within(double bound_mm) const { return station.tolerance_mm <= 0 || bound_mm <= station.tolerance_mm; }
  bool within() const { return within(worst_95_mm); }
};

/// Panel pixels and bounds of a station anew, for what is known of the mirror's angles there. Error:
/// kStationOutOfReach, a corner is behind the lens or hidden from an eye.
Status set_bounds(const calib::steer::InRoom& rig, calib::steer::LookState state, AimedStation& station);

/// `scene`: what was scanned, or null. Errors: kStationOutOfReach (first station that is), kSurfaceMissing (a station
/// on the scanned surface without a scan, or that the scan does not reach), kBadValue (an eye that a picture cannot be
/// drawn for).
Result<std::vector<AimedStation>> aim_stations(const calib::steer::InRoom& rig,
                                               const proto::stations::Stations& stations, const Scene* scene = nullptr);

}  // namespace raysteer::host::rig
