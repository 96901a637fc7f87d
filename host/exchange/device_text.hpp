// pure: the parts that our calibration files share, as TOML text.
#pragma once

#include <Eigen/Dense>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "calib/model/rig.hpp"
#include "host/exchange/number_text.hpp"

namespace raysteer::host::exchange {

/// "[0.1, 800.0]", exact.
std::string number_array(std::span<const double> values);
/// A [[device]] table.
std::string device_text(const calib::model::Device& device);
/// A [covariance] table.
std::string covariance_text(const std::vector<std::string>& parameters, const Eigen::MatrixXd& covariance);
/// 16 hexadecimal digits that stand for a text.
std::string text_id(std::string_view text);

}  // namespace raysteer::host::exchange
