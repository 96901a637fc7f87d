// The rig tied to the room: datums that both eyes saw against their survey.
//
// A blank floor cannot give x, y and turn; datums can, and the lengths between them are the one check of scale that
// calibration never used. What does not fit is not averaged away: a scale, two exchanged numbers and moved datums are
// tried as explanations, and the one that explains it is named.
#pragma once

#include <Eigen/Dense>
#include <optional>
#include <string>
#include <vector>

#include "calib/datum/measure.hpp"
#include "calib/model/pose.hpp"
#include "calib/model/rig.hpp"
#include "hal/base/result.hpp"
#include "proto/survey/survey.hpp"

namespace raysteer::calib::datum {

/// How far a datum was measured from where the survey and all datums together put it.
struct Miss {
  std::string name;
  unsigned code = 0;
  Eigen::Vector3d miss_m;   ///< measured minus surveyed, the room's frame
  Eigen::Vector3d sigma_m;  ///< of it, survey and measurement together; before the fit took its share
};

/// A length measured by the cameras alone, against what is known of it.
struct Length {
  std::string from, to;
  double measured_m = 0;
  double known_m = 0;
  double sigma_m = 0;  ///< of the difference
};

/// The rig's metre in the room's metres: 1.002 when it measures 1002 mm where there are 1000.
struct Scale {
  double value = 1;
  double sigma = 0;
  bool by_lengths = false;  ///< from known lengths; else from the surveyed places
};

struct Tie {
  model::Pose T_room_rig;
  Eigen::Matrix<double, 6, 6> cov;  ///< of its left increment (model::moved_by): rotation, translation
  Eigen::MatrixXd cov_cameras;      ///< of that increment with the cameras' parameters: 6 x P
  std::vector<Miss> misses;         ///< in the survey's order
  double whitened_rms = 0;          ///< of the misses; 1 when survey and cameras are as good as they say
  int dof = 0;
  std::optional<Scale> scale;   ///< not when the rig surveyed the datums itself and no length is known
  std::vector<Length> lengths;  ///< those of the survey whose ends were measured
  std::vector<std::string> not_seen;
  std::vector<unsigned> not_surveyed;
};

struct TieOptions {
  std::vector<std::string> leave_out;  ///< names of datums not to use: known to have moved
};

/// Ties the rig of `views` to the room of `survey`. Where fits are worse than stated (but nothing is wrong by more than
/// a millimetre and two per mille), the covariance is raised to what was seen.
/// Errors: those of measure(), and kDatumsMissing: fewer than three usable ones, or all in a line: consistent with
/// itself, not tied to the room; kDatumsExchanged and kDatumMoved name the datums; kScaleWrong says by how much;
/// survey's check()'s.
Result<Tie> tie_to_room(const model::Rig& cameras, const proto::survey::Survey& survey, const std::vector<View>& views,
                        const TieOptions& options = {});

/// A survey by the rig itself: the room's z = 0 is the plane through the datums, z towards the rig, its origin the
/// first datum (by code) put onto that plane, x towards the second. Named "datum CODE". Errors: those of measure(),
/// kDatumsMissing, kSurveyUnusable.
Result<proto::survey::Survey> survey_from(const model::Rig& cameras, const std::vector<View>& views);

}  // namespace raysteer::calib::datum
