// Several views of a datum by one eye as one; views that do not agree are found.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "calib/datum/measure.hpp"
#include "hal/base/result.hpp"

namespace raysteer::calib::datum {

struct MeanSighting {
  Eigen::Vector2d q;
  Eigen::Matrix2d cov;
};

/// By code: what each eye saw on average; nothing from an eye that never did.
/// Errors: kNotFinite, kRigMoved, kDatumMoved, as measure() says.
Result<std::map<unsigned, std::array<std::optional<MeanSighting>, 2>>> steady(const std::vector<View>& views);

}  // namespace raysteer::calib::datum
