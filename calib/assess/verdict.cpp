#include "calib/assess/verdict.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <string>

namespace raysteer::calib::assess {
namespace {

// What is good, and what is still usable (algorithms 1.4 and 10.7; RMS there per coordinate, here two-dimensional).
struct Limits {
  double good;
  double usable;
};
constexpr Limits kRms{0.28, 0.50};               // px
constexpr Limits kHeldOut{0.50, 1.20};           // px, 95 %
constexpr Limits kOddEven{0.30, 2.00};           // px, 95 % of the map
constexpr Limits kCameraFocal{0.0005, 0.004};    // of the focal length
constexpr Limits kCameraCentre{0.5, 8};          // px
constexpr Limits kProjectorFocal{0.0010, 0.01};  // of the focal length
constexpr Limits kProjectorCentre{1.0, 20};      // px
constexpr double kKept = 0.95;                   // of the corners
constexpr double kKeptLeast = 0.70;
constexpr int kGoodViews = 10;
constexpr double kGoodTilt = 40 * 3.14159265358979 / 180;   // spread about each axis: +-20 degrees
constexpr double kLeastTilt = 10 * 3.14159265358979 / 180;  // about either

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...) {
  std::array<char, 256> buffer{};
  std::va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer.data(), buffer.size(), format, arguments);
  va_end(arguments);
  return buffer.data();
}

class Judge {
 public:
  explicit Judge(Assessment& assessment) : assessment_(assessment) { assessment_.verdict = Verdict::kGood; }

  /// A number that should be small. NaN counts as too large.
  void below(double value, Limits limits, const std::string& reason, const std::string& advice) {
    if (value <= limits.good) {
      return;
    }
    lower(value <= limits.usable ? Verdict::kUsable : Verdict::kRedo, reason, advice);
  }
  void lower(Verdict verdict, const std::string& reason, const std::string& advice) {
    assessment_.verdict = std::max(assessment_.verdict, verdict);
    assessment_.reasons.push_back(reason);
    if (!advice.empty() && std::ranges::find(assessment_.advice, advice) == assessment_.advice.end()) {
      assessment_.advice.push_back(advice);
    }
  }

 private:
  Assessment& assessment_;
};

void judge_device(const solve::Solution& solution, std::size_t d, const DeviceAssessment& device, Judge& judge) {
  const bool projector = solution.rig.devices[d].kind == model::DeviceKind::kProjector;
  const char* name = device.name.c_str();
  const solve::DeviceFit& fit = solution.devices[d];
  judge.below(fit.rms_px, kRms, text("%s misses its corners by %.2f px RMS", name, fit.rms_px),
              "Check focus, motion blur and that the board is flat and stiff.");
  if (fit.kept_share() < kKept) {
    judge.lower(fit.kept_share() < kKeptLeast ? Verdict::kRedo : Verdict::kUsable,
                text("%.0f %% of the corners of %s were left out as outliers", 100 * (1 - fit.kept_share()), name),
                "Use a flat, stiff board: corners left out near one of its edges mean that it is bent there.");
  }
  const auto parameter = [&](std::string_view wanted) -> const Parameter& {
    const auto found =
        std::ranges::find_if(device.parameters, [&](const Parameter& p) { return p.name.ends_with(wanted); });
    RAYSTEER_CHECK(found != device.parameters.end());
    return *found;
  };
  const Parameter& fx = parameter(".fx");
  judge.below(fx.sigma / fx.value, projector ? kProjectorFocal : kCameraFocal,
              text("the focal length of %s is known to %.2f %% only", name, 100 * fx.sigma / fx.value),
              "Add views with the board tilted by 20 to 45 degrees, at other distances.");
  const double centre = std::max(parameter(".cx").sigma, parameter(".cy").sigma);
  judge.below(centre, projector ? kProjectorCentre : kCameraCentre,
              text("the principal point of %s is known to %.1f px only", name, centre),
              "Add views with the board turned in its plane and tilted the other way.");
  if (std::isfinite(device.odd_even_p95_px)) {
    judge.below(
        device.odd_even_p95_px, kOddEven,
        text("calibrations of %s from odd and from even views differ by %.2f px (95 %%)", name, device.odd_even_p95_px),
        "Add views; a low RMS with a large difference means a bent board, blur or a moving board.");
  }
  if (device.coverage.cells_short > 0 && !projector) {
    judge.lower(Verdict::kUsable,
                text("%d of %zu cells of the image of %s hold fewer than 100 corners", device.coverage.cells_short,
                     device.coverage.corners.values.size(), name),
                "Add views with the board in the parts of the image that the coverage map shows empty.");
  }
  if (d == 0) {
    const double least = std::min(device.coverage.tilt_x_rad, device.coverage.tilt_y_rad);
    const double most = std::max(device.coverage.tilt_x_rad, device.coverage.tilt_y_rad);
    if (least < kGoodTilt) {
      judge.lower(most < kLeastTilt ? Verdict::kRedo : Verdict::kUsable,
                  text("the board's tilt spreads over %.0f and %.0f degrees about the two axes", 57.29578 * least,
                       57.29578 * most),
                  "Add views with the board tilted by 20 to 30 degrees to all four sides.");
    }
  }
}

}  // namespace

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::kGood:
      return "good";
    case Verdict::kUsable:
      return "usable";
    case Verdict::kRedo:
      return "redo";
  }
  return "redo";
}

void judge(const solve::Solution& solution, Assessment& assessment) {
  Judge judge(assessment);
  for (std::size_t d = 0; d < assessment.devices.size(); ++d) {
    judge_device(solution, d, assessment.devices[d], judge);
  }
  const CrossValidation& cross = assessment.cross_validation;
  judge.below(cross.p95_px, kHeldOut, text("corners of views left out are missed by %.2f px (95 %%)", cross.p95_px),
              "Add views; the calibration does not yet predict new ones.");
  int used = 0;
  for (const solve::ViewFit& view : solution.views) {
    used += view.used ? 1 : 0;
    if (!view.used) {
      judge.lower(Verdict::kUsable, "view '" + view.name + "' was left out: " + view.why_note,
                  "Look at the views left out; record them again.");
    }
  }
  if (used < kGoodViews) {
    judge.lower(Verdict::kUsable, text("only %d views were used", used), "Record at least 10 views.");
  }

  std::string numbers;
  for (const solve::DeviceFit& fit : solution.devices) {
    numbers += text("%s%s %.2f px", numbers.empty() ? "" : ", ", fit.name.c_str(), fit.rms_px);
  }
  assessment.summary = std::string(to_string(assessment.verdict)) + ": corners fit within " + numbers +
                       text(" RMS, unseen ones within %.2f px (95 %%)", cross.p95_px);
  if (cross.leave_one_out_px > 0) {
    assessment.summary += text(", the projector hits poses left out within %.2f px RMS", cross.leave_one_out_px);
  }
}

}  // namespace raysteer::calib::assess
