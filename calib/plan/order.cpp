#include "calib/plan/order.hpp"

#include <algorithm>
#include <numeric>

namespace raysteer::calib::plan {
namespace {

bool from_above(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  return (to.array() < from.array() - 1e-12).any();
}

/// Travel of the slower axis, and for an approach from above more than any tour's travel.
double cost(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Eigen::Vector2d& span) {
  constexpr double kFromAbove = 1e4;
  return ((to - from).array() / span.array()).abs().maxCoeff() + (from_above(from, to) ? kFromAbove : 0);
}

}  // namespace

int approached_from_above(std::span<const Eigen::Vector2d> commands_rad) {
  int count = 0;
  for (std::size_t i = 1; i < commands_rad.size(); ++i) {
    count += from_above(commands_rad[i - 1], commands_rad[i]) ? 1 : 0;
  }
  return count;
}

std::vector<std::size_t> visiting_order(std::span<const Eigen::Vector2d> commands_rad,
                                        const Eigen::Vector2d& span_rad) {
  const auto total = [&](const std::vector<std::size_t>& order) {
    double sum = 0;
    for (std::size_t i = 1; i < order.size(); ++i) {
      sum += cost(commands_rad[order[i - 1]], commands_rad[order[i]], span_rad);
    }
    return sum;
  };
  std::vector<std::size_t> order(commands_rad.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](std::size_t i) {
    return commands_rad[i].x() / span_rad.x() + commands_rad[i].y() / span_rad.y();
  });
  // Runs of looks move elsewhere as long as that helps. A tour of a few dozen looks needs no better search.
  double best = total(order);
  for (bool better = true; better;) {
    better = false;
    for (std::size_t length = 1; length <= order.size() / 2; ++length) {
      for (std::size_t from = 0; from + length <= order.size(); ++from) {
        for (std::size_t to = 0; to + length <= order.size(); ++to) {
          std::vector<std::size_t> trial = order;
          const auto first = trial.begin() + static_cast<std::ptrdiff_t>(std::min(from, to));
          const auto last = trial.begin() + static_cast<std::ptrdiff_t>(std::max(from, to) + length);
          std::rotate(
              first,
              to < from ? last - static_cast<std::ptrdiff_t>(length) : first + static_cast<std::ptrdiff_t>(length),
              last);
          const double sum = total(trial);
          if (sum < best - 1e-9) {
            best = sum;
            order = std::move(trial);
            better = true;
          }
        }
      }
    }
  }
  return order;
}

}  // namespace raysteer::calib::plan
