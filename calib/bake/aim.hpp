// pure: the mirror command for a place, and for a station.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <optional>
#include <string>

#include "calib/bake/station.hpp"
#include "calib/model/steered_projector.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::bake {

/// The command at which panel pixel `x` lights the rig-frame point `p`: Newton from `start_rad`, to 1e-9 px. May lie
/// somewhat out of range: the model goes on there. Nothing when it does not converge.
std::optional<Eigen::Vector2d> command_near(const model::SteeredProjector& projector, const Eigen::Vector3d& p,
                                            const Eigen::Vector2d& x, const Eigen::Vector2d& start_rad);

/// The same from the best of a grid of commands over the range.
std::optional<Eigen::Vector2d> command_for(const model::SteeredProjector& projector, const Eigen::Vector3d& p,
                                           const Eigen::Vector2d& x);

/// Middle of the panel, px.
inline Eigen::Vector2d panel_middle(const model::SteeredProjector& projector) {
  return 0.5 * Eigen::Vector2d(projector.lens.width - 1, projector.lens.height - 1);
}

/// The command that shows the station in the panel's middle, or as near to it as the range allows; its own, if it has
/// one. Error kStationOutOfReach, when a corner gets no light: which, and how far beyond the light it lies.
Result<Eigen::Vector2d> station_command(const model::SteeredProjector& projector, const Station& station);

/// The same for four places in the order of kCornerNames, which need not lie in a plane. Error kStationOutOfReach.
Result<Eigen::Vector2d> command_showing(const model::SteeredProjector& projector, const std::string& name,
                                        const std::array<Eigen::Vector3d, 4>& corners);

}  // namespace raysteer::calib::bake
