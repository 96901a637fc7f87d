#include "calib/solve/held_out.hpp"

#include <algorithm>
#include <cmath>

#include "calib/solve/adjust.hpp"
#include "calib/solve/residual.hpp"

namespace raysteer::calib::solve {
namespace {

// Every second corner of the target, like the black squares of a chessboard.
bool places_the_view(const TargetSpec& target, const CornerMeasurement& corner) {
  return (corner.id % target.corner_columns() + corner.id / target.corner_columns()) % 2 == 0;
}

}  // namespace

Result<double> held_out_error(const Measurements& measurements, const State& start, int folds,
                              std::vector<double>* errors) {
  // Views that have corners, dealt to the folds in turn.
  std::vector<int> fold(start.T_rig_target.size(), -1);
  int next = 0;
  for (std::size_t v = 0; v < fold.size(); ++v) {
    const bool seen = std::ranges::any_of(measurements.corners, [&](const CornerMeasurement& corner) {
      return static_cast<std::size_t>(corner.view) == v;
    });
    if (seen) {
      fold[v] = next++ % folds;
    }
  }
  double squares = 0;
  int count = 0;
  for (int f = 0; f < std::min(folds, next); ++f) {
    Measurements training = measurements;
    std::erase_if(training.corners,
                  [&](const CornerMeasurement& corner) { return fold[static_cast<std::size_t>(corner.view)] == f; });
    std::erase_if(training.pixels,
                  [&](const PixelMeasurement& pixel) { return fold[static_cast<std::size_t>(pixel.view)] == f; });
    State state = start;
    if (const auto report = adjust(training, {.max_iterations = 30}, state); !report) {
      return report.error();
    }
    Measurements placing = measurements;
    placing.pixels.clear();
    std::erase_if(placing.corners, [&](const CornerMeasurement& corner) {
      return fold[static_cast<std::size_t>(corner.view)] != f || !places_the_view(measurements.target, corner);
    });
    const std::vector<bool> none(state.devices.size(), false);
    const AdjustOptions pose_only{.free_intrinsics = none, .free_pose = none, .free_sag = false, .max_iterations = 20};
    if (const auto report = adjust(placing, pose_only, state); !report) {
      return report.error();
    }
    for (const CornerMeasurement& corner : measurements.corners) {
      if (fold[static_cast<std::size_t>(corner.view)] != f || places_the_view(measurements.target, corner)) {
        continue;
      }
      const auto d = static_cast<std::size_t>(corner.device);
      Eigen::Vector2d error;
      if (!corner_residual(measurements.target, corner, state.devices[d].camera, state.devices[d].T_device_rig,
                           state.T_rig_target[static_cast<std::size_t>(corner.view)], state.sag, error, nullptr)) {
        return fail(RCode::kSolverDiverged, "a held-out corner lies behind its camera");
      }
      squares += error.squaredNorm();
      ++count;
      if (errors != nullptr) {
        errors->push_back(error.norm());
      }
    }
  }
  if (count == 0) {
    return fail(RCode::kTooFewViews, "no corners were left to test with");
  }
  return std::sqrt(squares / count);
}

}  // namespace raysteer::calib::solve
