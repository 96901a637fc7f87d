// pure: which of many looks to take, so that predictions over the reach become as sure as they can (I-optimal).
#pragma once

#include <Eigen/Dense>
#include <span>
#include <vector>

#include "calib/plan/forecast.hpp"

namespace raysteer::calib::plan {

/// With three levels of an axis's command the cubic looks like gain: a fit that looks perfect predicts nothing between.
constexpr int kFewestLevels = 4;

/// A candidate: its forecast and where it stands on the grid of commands.
struct Candidate {
  LookForecast forecast;
  int column = 0;  ///< level of axis 1
  int row = 0;     ///< level of axis 2
};

/// trace((1 + sum of information)^-1 spread): mean squared error of predictions after these looks.
double mean_squared(const Eigen::MatrixXd& information, const Eigen::MatrixXd& spread);

/// Indices of `count` different candidates: greedily, then by exchanges while one helps (Fedorov, at most four rounds).
/// Never fewer than kFewestLevels per axis where the candidates have them. `spread` is the mean over the reach.
std::vector<std::size_t> choose(std::span<const Candidate> candidates, const Eigen::MatrixXd& spread,
                                std::size_t count);

}  // namespace raysteer::calib::plan
