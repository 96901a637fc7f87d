// value: what calibrating, baking or verifying a steered rig found, as result.json holds it and report.html draws it.
//
// Places are on the floor of the drawing, metres: x to the right, y up the page; lengths there are millimetres.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/report/parts.hpp"

namespace raysteer::host::report {

/// A piece of the reach, or of a map of differences.
struct FloorCell {
  std::vector<double> outline_m{};  ///< x0, y0, x1, y1, ...
  double mm = kUnknown;
};

/// From a place to another, drawn longer than it is.
struct FloorArrow {
  double x_m = 0, y_m = 0;
  double dx_mm = 0, dy_mm = 0;
};

struct LookRow {
  std::string name{};
  bool held_out = false;
  double x_m = kUnknown, y_m = kUnknown;  ///< where the picture's middle falls
  std::vector<double> command_mrad{};
  std::vector<double> latent_urad{};  ///< of a look that was solved with: what the mirror stood off its curve
  double whitened_rms = kUnknown;     ///< likewise
  double median_px = kUnknown;        ///< of a look held out: what it was missed by
  double p95_px = kUnknown;
};

struct DatumRow {
  std::string name{};
  double x_m = kUnknown, y_m = kUnknown;
  std::vector<double> miss_mm{};  ///< measured minus surveyed: x, y, z of the room
  double size_mm = kUnknown;      ///< of the miss
  double sigma_mm = kUnknown;     ///< its largest axis
};

struct LengthRow {
  std::string between{};
  double measured_mm = 0;
  double known_mm = 0;
  double sigma_mm = 0;
};

struct StationRow {
  std::string name{};
  std::vector<double> outline_m{};  ///< x0, y0, ... of its corners
  double bound_95_mm = kUnknown;    ///< predicted, or what was measured and what the measurement may be off by
  double error_mm = kUnknown;       ///< measured, of the worst corner
  double sure_mm = kUnknown;        ///< of it
  double tolerance_mm = 0;          ///< 0: none asked
  bool within = true;
  std::vector<FloorArrow> off{};  ///< measured, at the corners
  double moved_mm = kUnknown;     ///< against the earlier calibration, worst corner
};

struct OffDrawingRow {
  std::string parameter{};
  double sigmas = 0;
};

/// Against an earlier calibration of the same rig.
struct RigDifferenceResult {
  std::string earlier{};  ///< its id
  std::string frame{};    ///< "the room", "the rig's own frame"
  std::string sentence{};
  double mean_mm = kUnknown, p95_mm = kUnknown, max_mm = kUnknown;
  double whole_rms_mm = kUnknown;
  double inside_rms_mm = kUnknown;
  double beyond_chance = kUnknown;
  double turned_mrad = kUnknown;  ///< the rig as a whole
  double shifted_mm = kUnknown;
  std::vector<FloorCell> cells{};
  std::vector<FloorArrow> arrows{};
};

struct RigResult {
  std::string kind = "rig";  ///< "rig", "tables", "verification"
  Judgement judgement;
  std::string session{};
  std::string board{};
  std::string calibration_id{};
  std::string floor{};               ///< what the drawing's floor is; empty: nothing to draw on
  std::vector<double> floor_pose{};  ///< T_floor_frame: rotation w, x, y, z, translation; the room's or the rig's frame
  bool tied_to_room = false;
  double reach_median_95_mm = kUnknown;
  double reach_worst_95_mm = kUnknown;
  std::vector<FloorCell> reach{};
  std::vector<LookRow> looks{};
  std::vector<FloorArrow> held_out{};  ///< predicted minus measured, the noise averaged out
  double held_out_median_px = kUnknown, held_out_p95_px = kUnknown;
  double held_out_median_mm = kUnknown, held_out_p95_mm = kUnknown;
  double whitened_rms = kUnknown;
  double repeatability_urad = kUnknown;
  std::int64_t points_used = 0, points_dropped = 0;
  int panel_width = 0, panel_height = 0;
  std::vector<ResidualVector> residuals{};  ///< on the panel
  std::vector<DatumRow> datums{};
  double scale = kUnknown, scale_sigma = kUnknown;  ///< the rig's metre in the room's
  bool scale_by_lengths = false;
  std::vector<LengthRow> lengths{};
  std::vector<OffDrawingRow> off_drawing{};
  std::vector<StationRow> stations{};
  std::vector<RigDifferenceResult> difference{};  ///< none or one
  std::vector<Fact> facts{};                      ///< further lines for the table
};

}  // namespace raysteer::host::report
