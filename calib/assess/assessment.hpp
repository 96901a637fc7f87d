// value: is the calibration good enough, and where is it not? Plain numbers for the report.
#pragma once

#include <Eigen/Dense>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/rcode.hpp"

namespace raysteer::calib::assess {

/// A value per cell of a device's image, row by row from the top left; cells are equal. NaN: nothing known there.
struct GridMap {
  int columns = 0;
  int rows = 0;
  std::vector<double> values;
  double at(int column, int row) const { return values[static_cast<std::size_t>(row * columns + column)]; }
};

/// Sigma of the projection (px, larger axis) of points at one range, after the rigid motion that best explains the
/// parameters' error is taken out (mrcal's projection uncertainty; algorithms 1.4). 10 x 8 cells.
struct UncertaintyMap {
  double range_m = 0;  ///< infinity: directions
  GridMap sigma_px;
};

struct Parameter {
  std::string name;  ///< "left.fx"
  double value = 0;
  double sigma = 0;
  std::string unit;  ///< "px", "rad", "m", ""
};

struct Coverage {
  GridMap corners;        ///< kept corners per cell, 5 x 4
  int cells_short = 0;    ///< cells with fewer than 100
  double tilt_x_rad = 0;  ///< spread (largest minus smallest) of the target's tilt about the image's x axis
  double tilt_y_rad = 0;  ///< ... about its y axis
  double nearest_m = 0;
  double farthest_m = 0;
};

struct DeviceAssessment {
  std::string name;
  std::vector<Parameter> parameters;
  Coverage coverage;
  std::vector<UncertaintyMap> uncertainty;
  /// Difference in px of two calibrations, from odd and from even views, implied rotation removed; 10 x 8 cells.
  GridMap odd_even_px;
  double odd_even_median_px = 0;
  double odd_even_p95_px = 0;
};

/// Errors of corners the calibration had not seen, two-dimensional px: views are left out in turn, the target's pose
/// in such a view is fitted to every second corner (of all devices), and the others are the test.
struct CrossValidation {
  int folds = 0;
  int corners = 0;
  double rms_px = 0;
  double median_px = 0;
  double p95_px = 0;
  /// With a projector: each pose left out in turn, placed by its camera corners alone; RMS on the panel.
  double leave_one_out_px = 0;
};

/// Against an earlier calibration, per device: where pixels moved, and what that is in millimetres.
struct Difference {
  std::string device;
  GridMap px;  ///< 10 x 8
  GridMap mm;  ///< at `range_m`
  double range_m = 0;
  double median_px = 0;
  double p95_px = 0;
};

enum class Verdict { kGood, kUsable, kRedo };
std::string_view to_string(Verdict verdict);  // "good", "usable", "redo"

struct Assessment {
  Verdict verdict = Verdict::kRedo;
  std::string summary;               ///< one sentence: "good: left 0.16 px, ..."
  std::vector<std::string> reasons;  ///< why not better, each a sentence
  std::vector<std::string> advice;   ///< what to add or change, each a sentence
  CrossValidation cross_validation;
  std::vector<DeviceAssessment> devices;
  std::vector<std::string> correlated;  ///< "left.fx ~ left.k1: 0.97": pairs above 0.95
  std::vector<Difference> differences;  ///< empty without an earlier calibration
};

}  // namespace raysteer::calib::assess
