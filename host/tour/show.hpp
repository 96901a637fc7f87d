// Pictures shown on the pretend rig at one look (docs/show-format.md): asks raysteer-sim, reads what it answers.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calib/model/pose.hpp"
#include "hal/base/image.hpp"
#include "hal/base/result.hpp"
#include "host/sim/pretend_options.hpp"
#include "host/sim/program.hpp"

namespace raysteer::host::tour {

/// A person's view of the room: a pinhole, its principal point in the middle. Rig frame, metres.
struct RoomView {
  int width = 0;
  int height = 0;
  double focal_px = 0;
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();
  Eigen::Vector3d look_at = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();  ///< any direction that is up in the picture

  /// Where it sees a point; no value behind the eye.
  std::optional<Eigen::Vector2d> pixel(const Eigen::Vector3d& p) const;
};

struct ShowRequest {
  std::array<double, 2> mirror_rad{};
  /// What a person does first, one for all pictures or one a picture: "target pose 3".
  std::vector<std::string> prepare{"target on floor"};
  bool expose_for_first = false;  ///< the first picture, not white, decides the exposure
  bool photograph = true;
  std::optional<RoomView> room;
  std::vector<Eigen::Vector2d> panel_pixels;
};

struct Shown {
  std::array<std::vector<std::filesystem::path>, 2> frames;  ///< left, right: a raw frame a picture
  std::vector<std::filesystem::path> room;
  // The truth, for errors only:
  std::vector<std::optional<Eigen::Vector3d>> lit_points;  ///< one a panel pixel, rig frame
  std::optional<calib::model::Pose> T_rig_target;
};

/// Shows `pictures` in order. `folder` is created and keeps what was written.
/// Errors: those of sim::run; kWriteFailed, kDiskFull; kBadValue: an answer that says something else than asked.
Result<Shown> show(const sim::PretendOptions& pretend, const ShowRequest& request,
                   const std::vector<Image<std::uint8_t>>& pictures, const std::filesystem::path& folder,
                   const sim::Listener& listener);

}  // namespace raysteer::host::tour
