// value: a rig's description ("board file"): what is fitted, how it is drawn, what it may do. docs/board-format.md.
//
// Both ends read it: the device builds its back ends and limits from it, the laptop starts calibrations from its
// drawings. Drawings are nominal; `tolerance` says how far a real rig may be off. Never the truth of a pretend rig.
//
// Frames (docs/conventions.md): rig = left camera, x right, y down, z forward. Mirrors are drawn in the projector's
// frame. Lengths in metres, angles in radians, mechanical.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/result.hpp"

namespace raysteer::proto::board {

using Vec3 = std::array<double, 3>;

/// A pose T_to_from: X_to = R X_from + t, R from a rotation vector.
struct Pose {
  Vec3 rotation{};
  Vec3 translation{};
  bool operator==(const Pose&) const = default;
};

struct Lens {
  double focal_px = 0;
  std::array<double, 2> centre_px{};   ///< principal point; may lie outside the picture (lens shift)
  std::array<double, 4> distortion{};  ///< k1, k2, p1, p2
  bool operator==(const Lens&) const = default;
};

enum class ProjectorKind { kDisplay, kTriggerMaster };

struct Projector {
  ProjectorKind kind = ProjectorKind::kDisplay;
  int width = 0;
  int height = 0;
  double frame_rate_hz = 60;
  Lens lens;
  Pose T_projector_rig;
  double lumens = 0;   ///< white, whole panel
  double focus_m = 0;  ///< sharp at this distance along the light's way from the lens
  double pupil_m = 0;  ///< diameter of the lens's exit pupil: how fast it blurs away from there
  double gamma = 1;    ///< light = code^gamma, as far as the data sheet says
  bool operator==(const Projector&) const = default;
};

/// A mirror that turns about a line: surface point at rest = axis point + offset along the normal (algorithms 4.4).
struct MirrorPlane {
  Vec3 axis{};                     ///< direction of the line, unit
  Vec3 point{};                    ///< a point on it
  Vec3 normal{};                   ///< at rest, unit, towards the light
  double offset_m = 0;             ///< of the reflecting surface from the axis, along the normal
  std::array<double, 2> size_m{};  ///< full width across and length along the axis of its outline, centred on the axis
  bool ellipse = true;             ///< outline: ellipse or rectangle
  bool operator==(const MirrorPlane&) const = default;
};

enum class MirrorKind { kGalvoPair, kHead };

struct Mirror {
  MirrorKind kind = MirrorKind::kGalvoPair;
  std::string preset;               ///< how it moves: "galvo", "head", "cheap-head" (hal/mock)
  std::vector<MirrorPlane> planes;  ///< galvo pair: 2, light meets [0] first; head: 1, whose axis is the inner one
  Vec3 outer_axis{};                ///< head: direction of the outer axis; carries the inner one
  Vec3 outer_point{};               ///< head: a point on it
  std::array<double, 2> half_range_rad{};  ///< u = angle / half range runs from -1 to 1
  std::array<double, 2> least_rad{};       ///< limits: what may be commanded
  std::array<double, 2> most_rad{};
  double settle_tolerance_rad = 0;
  double settle_window_s = 0;
  double settle_timeout_s = 0;
  bool operator==(const Mirror&) const = default;
};

struct Camera {
  std::string name;    ///< "left", "right"
  std::string serial;  ///< empty: any
  int width = 0;
  int height = 0;
  int bits = 8;
  Lens lens;
  Pose T_camera_rig;
  double f_number = 0;
  double pixel_m = 0;  ///< pitch
  double full_well_e = 0;
  double read_noise_e = 0;
  double quantum_efficiency = 0;
  double least_exposure_s = 0;
  double most_exposure_s = 0;
  double least_period_s = 0;
  bool operator==(const Camera&) const = default;
};

/// One standard deviation of what a workshop delivers, for priors and for drawing pretend rigs (algorithms 4.8).
struct Tolerance {
  double axis_rad = 0;
  double position_m = 0;
  double zero_rad = 0;
  double gain = 0;
  double quadratic = 0;
  double cubic = 0;
  double cross_talk = 0;
  double focal = 0;       ///< relative
  double centre = 0;      ///< of the focal length
  double distortion = 0;  ///< of k1
  double mount_rad = 0;
  double mount_m = 0;
  bool operator==(const Tolerance&) const = default;
};

/// A fault asked for: which device, what, when, how often. "left.drop@2s*3" on the command line.
struct Fault {
  std::string device;  ///< "mirror", "projector", "left", "right", "cameras", "trigger", "interlock", "store", "clock"
  std::string what;    ///< a word that device knows; hal/mock lists them
  double at_s = 0;     ///< rig time from which it may happen
  int times = 1;       ///< 0: for ever
  double amount = 0;   ///< unit depends on the word; 0: its own default
  bool operator==(const Fault&) const = default;
};

struct Board {
  std::string name;
  std::string back_end;  ///< "mock"
  Projector projector;
  Mirror mirror;
  std::vector<Camera> cameras;  ///< left, right
  Tolerance tolerance;
  std::vector<Fault> faults;
  bool operator==(const Board&) const = default;
};

/// Reads a board file. Errors name file, line and what was expected: kTomlSyntax, kFormatVersion, kUnknownKey,
/// kMissingKey, kBadValue.
Result<Board> read_board(std::string_view text, const std::string& file);

/// "DEVICE.WHAT[=AMOUNT][@SECONDSs][*TIMES]". kBadValue says what was expected.
Result<Fault> read_fault(std::string_view text);

}  // namespace raysteer::proto::board
