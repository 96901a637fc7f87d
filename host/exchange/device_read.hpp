// pure: the parts that our calibration files share, read and checked.
#pragma once

#include <Eigen/Dense>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/rig.hpp"
#include "hal/base/result.hpp"
#include "proto/document/toml_table.hpp"

namespace raysteer::host::exchange {

/// kTomlSyntax, with file and line.
Result<toml::table> parse_numbers(std::string_view text, std::string_view name);

/// A newer format may have anything else changed, so this comes before all other checks. kBadCalibrationFile (another
/// format), kFormatVersion, kNotFinite (naming the key).
Status check_format(const toml::table& root, std::string_view expected, std::int64_t version, std::string_view name);

/// `count` numbers, or a fault and zeros.
std::vector<double> numbers(proto::document::TomlTable& table, std::string_view key, std::size_t count);

/// "rotation_wxyz" and "translation_m". The first device's pose is none.
calib::model::Pose read_pose(proto::document::TomlTable& table, bool is_first);

/// A [[device]] table, finished.
calib::model::Device read_device(proto::document::TomlTable& table, bool is_first);

/// A [covariance] table of `count` parameters, finished. Faults: sizes, not symmetric, not positive semidefinite.
void read_covariance(proto::document::TomlTable& table, std::size_t count, std::vector<std::string>& parameters,
                     Eigen::MatrixXd& covariance);

}  // namespace raysteer::host::exchange
